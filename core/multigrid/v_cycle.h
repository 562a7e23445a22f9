/// One multigrid cycle in float or double: V or W, Cholesky on the last level.
///
/// The cycle is a symmetric operator (adjoint smoothing before and after, R and its transpose), so it can precondition
/// conjugate gradients.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/multigrid/coarse_solver.h"
#include "core/multigrid/lattice_hierarchy.h"
#include "core/multigrid/smoother.h"
#include "core/sparse/galerkin_gather.h"
#include "core/sparse/galerkin_stream.h"

namespace softreel {

/// Lengths of the two corrections by which a W improves a V.
struct CycleWeights {
  double first = 1, second = 1;
};

template <typename Scalar>
class Cycle {
 public:
  /// hierarchy and threads are kept by reference. What params leave open is chosen as for a homogeneous body.
  Cycle(const LatticeHierarchy& hierarchy, const MultigridParams& params, const Threads& threads);

  /// Takes the values of the mesh's matrix and rebuilds all levels. pinned: per mesh node, may be empty. False if the
  /// operators are not positive definite in this precision; then the cycle must not be applied.
  bool update(const BlockMatrixd& matrix, std::span<const std::uint8_t> pinned);

  /// The same with the values that finest_matrix() holds.
  bool update_in_place(std::span<const std::uint8_t> pinned);
  /// Takes the values that finest_matrix() holds for the finest level alone; the coarse ones, of an earlier update with
  /// the same pins, still make a symmetric preconditioner. A tenth of the time of an update.
  bool update_finest_in_place() { return levels_.front()->smoother->update(threads_); }
  /// The matrix of level 0: rows numbered by colour, blocks column-major.
  const BlockMatrix<Scalar>& finest_matrix() const { return levels_.front()->matrix; }
  BlockMatrix<Scalar>& finest_matrix() { return levels_.front()->matrix; }

  /// z = cycle applied to r, both in the order of the mesh's nodes. |r| scales the numbers so that float neither
  /// overflows nor underflows; above 0.
  void apply(const NodeVector<double>& r, double r_norm, NodeVector<double>& z);

  /// The vectors of level 0, in its own order: right_side() stays, result() = cycle applied to it. Needs two levels.
  NodeVector<Scalar>& right_side() { return levels_.front()->b; }
  const NodeVector<Scalar>& result() const { return levels_.front()->x; }
  void run() { cycle(0); }
  /// right_side() - A result() right after run(), for half a product by Gauss-Seidel and a whole one by other
  /// smoothers.
  const NodeVector<Scalar>& find_residual_of_result();
  /// right_side() - A x.
  const NodeVector<Scalar>& find_residual_of(const NodeVector<Scalar>& x);

  /// Bytes of level h: matrix, smoother, vectors, product plan, factors.
  std::int64_t bytes(std::size_t level) const;

 private:
  struct Level {
    Level(const LatticeLevel& structure, const MultigridParams& params, bool last);
    const LatticeLevel& structure;
    BlockMatrix<Scalar> matrix;
    NodeVector<Scalar> b, x, r, correction;
    std::unique_ptr<Smoother<Scalar>> smoother;      ///< all levels but the last
    std::unique_ptr<GalerkinGather<Scalar>> gather;  ///< the product to the next level, by the chosen method
    std::unique_ptr<GalerkinStream<Scalar>> stream;
  };

  void copy_values(const BlockMatrixd& matrix);
  void form_next(std::size_t h);
  void cycle(std::size_t h);
  void correct_from_next(std::size_t h);
  void cycle_again(std::size_t h, const CycleWeights& weights);

  const LatticeHierarchy& hierarchy_;
  MultigridParams params_;
  const Threads& threads_;
  std::vector<std::unique_ptr<Level>> levels_;
  CoarseSolver bottom_;
  std::vector<std::uint8_t> pinned_;  ///< in the order of level 0
};

}  // namespace softreel
