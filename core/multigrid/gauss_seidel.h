/// Block Gauss-Seidel over colours.
///
/// Rows of one colour share no block, so they are updated in parallel with the same bits at any thread count. A row's
/// blocks left of the diagonal belong to earlier colours. Two facts save reads of the matrix, which are the cost:
/// - going backward, the sum over the left half is the one that the forward sweep computed last, so it is kept;
/// - after a backward sweep b - A x = s - L x for the left sums s that it used and the strictly left half L.
/// Bound: a symmetric smoothing from zero with its residual reads the matrix 1.5 times, one from a given x 1.5 times;
/// one-way smoothing once each.
///
/// Several symmetric sweeps are lengthened by the weights of a Chebyshev polynomial: one such sweep S has the spectrum
/// of S A in (0, 1], so the errors 1 - S A of plain repetition can be bettered by a product of 1 - w_k S A (Golub and
/// Varga, Chebyshev semi-iterative methods, 1961). At Poisson's ratio 0.49, where nearly divergence-free modes a few
/// elements long are neither smoothed well nor carried by a coarse lattice, two weighted sweeps do what four plain ones
/// do.
#pragma once

#include <vector>

#include "core/multigrid/smoother.h"

namespace softreel {

enum class SweepDirections {
  Both,   ///< a sweep goes forward, then backward: symmetric by itself
  OneWay  ///< forward before the coarse correction, backward after it: the paper's 1 + 1
};

/// Lengths of `sweeps` symmetric sweeps, the longest first, so that the others damp its rounding; 1 for a single one.
std::vector<double> sweep_weights(int sweeps);

template <typename Scalar>
class GaussSeidel final : public Smoother<Scalar> {
 public:
  GaussSeidel(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix, SweepDirections directions);

  void smooth_from_zero(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                        const Threads& threads) override;
  void smooth(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) override;
  void find_smoothed_residual(const NodeVector<Scalar>& b, const NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                              const Threads& threads) const override;
  std::int64_t bytes() const override;

 private:
  using typename Smoother<Scalar>::Rows;
  using Smoother<Scalar>::level_;

  template <typename RowUpdate>
  void for_color(std::size_t color, const Threads& threads, const RowUpdate& update) const;
  void forward_from_zero(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);
  void forward(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);
  /// From the left sums of the forward sweep before.
  void backward(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);
  /// The same without such a sweep; keeps the left sums that it used.
  void backward_alone(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);
  /// One symmetric sweep of that length, from x or from zero whatever x holds.
  enum class Start { FromX, FromZero };
  template <Start start>
  void weighted_sweep(double weight, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads);
  /// r = b - A x after forward_from_zero.
  void find_residual_from_zero(const NodeVector<Scalar>& x, NodeVector<Scalar>& r, const Threads& threads) const;

  SweepDirections directions_;
  NodeVector<Scalar> left_sums_;      ///< b - D x - U x after the last sweep
  NodeVector<Scalar> before_, rest_;  ///< x and D x + U x before a weighted sweep; empty until there is one
};

}  // namespace softreel
