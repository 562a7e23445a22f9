/// Flexible conjugate gradients in double for symmetric positive definite block matrices, and the bare iteration with
/// the same preconditioner.
///
/// Notay, Flexible conjugate gradients (2000): beta = z . (r - r_old) / (z_old . r_old) keeps descent although a float
/// cycle is not quite the same symmetric operator every time.
#pragma once

#include <functional>
#include <span>

#include "core/base/parallel.h"
#include "core/multigrid/multigrid.h"
#include "core/sparse/block_kernels.h"
#include "core/sparse/block_matrix.h"
#include "core/sparse/solve_report.h"

namespace softreel {

/// What the solver asks of its preconditioner.
struct Preconditioner {
  /// z = M r, r_norm = |r| > 0.
  std::function<void(const NodeVector<double>& r, double r_norm, NodeVector<double>& z)> apply;
  /// Replaces M by a more exact one after stagnation or loss of definiteness; false if there is none.
  std::function<bool()> improve;
};

/// When to stop, and how to get there.
struct CgLimits {
  double tolerance = 1e-6;        ///< |b - A x| <= tolerance |b| ...
  double absolute_tolerance = 0;  ///< ... or <= this
  int max_iterations = 400;
  SolveMethod method = SolveMethod::ConjugateGradients;
};

/// The solver with its work vectors, kept between solves.
class ConjugateGradients {
 public:
  /// threads is kept by reference.
  explicit ConjugateGradients(const Threads& threads) : threads_(threads) {}

  /// Solves A x = b from x. b = 0 gives x = 0.
  SolveReport solve(const BlockMatrixd& A, std::span<const Vec3> b, std::span<Vec3> x, const CgLimits& limits,
                    const Preconditioner& preconditioner);

 private:
  enum class Step { Taken, Lost };
  /// Whether to go on; if not, the report has its status.
  enum class Verdict { GoOn, Stop };

  void start(const BlockMatrixd& A, std::span<const Vec3> b, std::span<Vec3> x);
  void refresh_residual(const BlockMatrixd& A);
  Step step(const BlockMatrixd& A, const CgLimits& limits, const Preconditioner& preconditioner);
  SolveStatus iterate(const BlockMatrixd& A, const CgLimits& limits, const Preconditioner& preconditioner,
                      int& iterations);
  Verdict judge_small_residual(const BlockMatrixd& A, double target, SolveStatus& status);
  Verdict recover(const BlockMatrixd& A, double target, bool lost, const Preconditioner& preconditioner,
                  SolveStatus& status);
  double rounding_floor(const BlockMatrixd& A) const;

  const Threads& threads_;
  NodeVector<double> b_, x_, r_, z_, p_, q_;
  double b_norm_ = 0, r_norm_ = 0;
  double rz_ = 0;     ///< z . r of the last step; 0 right after a start
  double alpha_ = 0;  ///< length of the last step
};

}  // namespace softreel
