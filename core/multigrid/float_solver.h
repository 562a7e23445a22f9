/// Conjugate gradients, or the bare cycles, in float on the finest level of a float cycle: one correction within a
/// refinement in double.
///
/// After its last sweep the cycle knows A z for half a product (Smoother::find_smoothed_residual), and A p follows from
/// it as p does from z: there is no product with A, and no matrix but the cycle's own. Bound: an iteration reads the
/// float matrix 3.5 times instead of 3 times (symmetric Gauss-Seidel) and a matrix in double once.
#pragma once

#include <span>

#include "core/base/parallel.h"
#include "core/multigrid/v_cycle.h"
#include "core/sparse/block_kernels.h"
#include "core/sparse/solve_report.h"

namespace softreel {

class FloatSolver {
 public:
  /// Both are kept by reference; the cycle needs two levels at least.
  FloatSolver(Cycle<float>& cycle, const Threads& threads) : cycle_(cycle), threads_(threads) {}

  /// Solves A y = r for r = cycle.right_side(), which becomes the residual, to |r| <= target in float arithmetic.
  /// guesses: directions that y may lie in, in the order of level 0. They are searched first, as if the cycle had
  /// proposed them, so the best multiple of each is taken and a bad one costs a product with A and nothing else.
  /// Status: Converged, MaxIterations, or Breakdown after stagnation or loss of definiteness.
  SolveReport solve(double target, int max_iterations, SolveMethod method,
                    std::span<const NodeVector<float>> guesses = {});

  /// The last solution, in the order of the cycle's level 0.
  const NodeVector<float>& solution() const { return x_; }

 private:
  struct Dots {
    double zr = 0, zq = 0, zAz = 0;
  };

  /// A direction that something proposes, and r - A z for r = cycle.right_side().
  struct Proposal {
    const NodeVector<float>& z;
    const NodeVector<float>& residual;
  };

  Dots find_dots(const Proposal& proposal) const;
  double advance(const Proposal& proposal, float beta, float alpha);
  void search(const NodeVector<float>& guess, double target, SolveReport& report);

  Cycle<float>& cycle_;
  const Threads& threads_;
  NodeVector<float> x_, p_, q_;  ///< q = A p
  double pq_ = 0;                ///< p . q; 0 before the first direction
};

}  // namespace softreel
