/// Chebyshev polynomial in D^-1 A with D the diagonal blocks: the smoother whose rows are all independent.
///
/// Adams, Brezina, Hu and Tuminaro, Parallel multigrid smoothing: polynomial versus Gauss-Seidel (2003). The upper end
/// of the spectrum is bounded by a few Lanczos steps at each update: Zhou and Li, Bounding the spectrum of large
/// Hermitian matrices (2011). Bound: degree d reads the matrix d times before the correction, d times after it, and an
/// update kLanczosSteps times.
#pragma once

#include "core/multigrid/smoother.h"

namespace softreel {

template <typename Scalar>
class Chebyshev final : public Smoother<Scalar> {
 public:
  /// degree: of the polynomial, at least 1; a sweep applies it once.
  Chebyshev(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix, int degree);

  bool update(const Threads& threads) override;
  void smooth_from_zero(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                        const Threads& threads) override;
  void smooth(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) override;
  std::int64_t bytes() const override;

  /// Bound on the eigenvalues of D^-1 A, from the last update: what the polynomial rests on. Asked for by tests, which
  /// compare it with the exact one.
  double largest_eigenvalue() const { return largest_; }

 private:
  using typename Smoother<Scalar>::Rows;
  using Smoother<Scalar>::level_;
  using Smoother<Scalar>::matrix_;

  double bound_spectrum(const Threads& threads);
  void start_lanczos(const Threads& threads);
  double lanczos_product(double previous_beta, const Threads& threads);
  double orthogonalize(double alpha, const Threads& threads);
  /// One application of the polynomial to the residual in r, added to x; r becomes the new residual if keep_residual.
  void apply(NodeVector<Scalar>& x, NodeVector<Scalar>& r, bool keep_residual, const Threads& threads);

  int degree_;
  double largest_ = 0;
  NodeVector<Scalar> direction_, next_;   ///< of the polynomial; in Lanczos the vector v and D v of the step before
  NodeVector<Scalar> residual_, scaled_;  ///< work of smooth; in Lanczos A v and D v
};

}  // namespace softreel
