/// The linear solver of softreel: conjugate gradients in double, preconditioned by a multigrid cycle in float.
///
/// Transfers and patterns depend on the mesh alone; `update` takes new matrix values (Galerkin products R K R^T on
/// every level, design 4.5), `solve` uses them. Pins never change the structure: they zero rows and columns of the fine
/// matrix.
///
/// A time step, which asks for three digits, may take the shorter way: assemble the float matrix in place
/// (float_matrix, update_in_float), solve in float (correct_in_float), and refine from the residual in double.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/timer.h"
#include "core/sparse/block_matrix.h"
#include "core/sparse/solve_report.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

enum class GalerkinMethod { Naive, Stream, Gather };
enum class CycleKind {
  Auto,  ///< W; FullW where coarse nodes may have copies by stiffness
  V,
  W,     ///< V on the finest level, W below
  FullW  ///< W from the finest level on, with weights: dearer, for what coarse lattices carry badly
};

/// What a solve iterates with.
enum class SolveMethod {
  ConjugateGradients,  ///< preconditioned by a cycle
  Cycles               ///< the cycle itself, as in the paper: x += cycle(b - A x)
};

enum class SmootherKind {
  GaussSeidel,        ///< forward and backward, before and after the coarse correction
  OneWayGaussSeidel,  ///< forward before, backward after: the paper's 1 + 1
  Chebyshev           ///< a polynomial in the matrix
};

struct MultigridParams {
  GalerkinMethod galerkin = GalerkinMethod::Gather;  ///< how R K R^T is formed; all agree to round-off
  SolveMethod method = SolveMethod::ConjugateGradients;
  CycleKind coarse_cycle = CycleKind::Auto;
  SmootherKind smoother = SmootherKind::GaussSeidel;
  /// Of the smoother, before and after the coarse correction. 0: 2 of symmetric Gauss-Seidel near incompressibility,
  /// where one takes too many iterations; else 1.
  int sweeps = 0;
  double poisson_ratio = 0;        ///< the body's greatest, by which `sweeps` = 0 goes
  int chebyshev_degree = 2;        ///< of the polynomial, if that is the smoother
  int bottom_nodes = 150;          ///< a level of at most this many nodes goes to Cholesky; slender ones sooner
  double dropped_weight = 0.1;     ///< transfer weights below are dropped, the rest renormalised
  double stiffness_contrast = 10;  ///< coarse nodes are copied per side of an edge of more contrast
};

/// The parameters with what they leave open (sweeps, coarse_cycle) chosen for a body. element_stiffness: as for
/// Multigrid.
MultigridParams choose_for_body(MultigridParams params, std::span<const double> element_stiffness);

/// One level as the report shows it.
struct LevelInfo {
  Index nodes = 0;
  std::int64_t blocks = 0;
  std::int64_t bytes = 0;
};

/// One solve in float, to be refined in double.
struct FloatCorrection {
  SolveReport report;
  /// About what rounding of the matrix and the sums to float may have left in r - A y beyond the target: some units of
  /// rounding of |diag(A)| |y|.
  double rounding = 0;
};

/// Hierarchy over one body. Deterministic at any thread count.
class Multigrid {
 public:
  /// element_stiffness: Young's modulus per element, Pa, for the copies at contrasts; empty: homogeneous.
  /// pattern: that of the fine matrix, stiffness_pattern(mesh.tets, nodes). threads is kept by reference.
  Multigrid(const TetMesh& mesh, std::span<const double> element_stiffness, const BlockPattern& pattern,
            const MultigridParams& params, const Threads& threads);
  ~Multigrid();
  Multigrid(Multigrid&&) noexcept;
  Multigrid& operator=(Multigrid&&) noexcept;

  /// Rebuilds all coarse operators and smoothers from a fine matrix: symmetric, positive definite on the nodes that are
  /// not pinned. A pinned node (pinned[i] != 0; empty: none) has zero rows and columns but for a diagonal block of at
  /// most the mean diagonal. The matrix is copied as far as the cycle needs it. Time goes to "update".
  void update(const BlockMatrixd& matrix, std::span<const std::uint8_t> pinned);

  /// Solves matrix * x = b to |b - A x| <= tolerance * |b| or <= absolute_tolerance, starting from x.
  /// matrix: that of the last update, or one near it (a lagged hierarchy stays a valid preconditioner).
  SolveReport solve(const BlockMatrixd& matrix, std::span<const Vec3> b, std::span<Vec3> x, double tolerance,
                    double absolute_tolerance, int max_iterations);

  /// The finest level's own matrix in float, for a caller that assembles it in place instead of copying it from one in
  /// double: rows numbered as row_of_node says, blocks column-major. Nothing but its values may change.
  BlockMatrixf& float_matrix();
  const std::vector<Index>& row_of_node() const;

  /// `update` from what float_matrix() holds; rows and columns of pinned nodes are eliminated first. False if
  /// correct_in_float cannot be used then: the matrix is not definite in float, or the mesh has one level only.
  /// keep_coarse: leaves the coarse levels as the last update_in_float, with the same pins, made them.
  bool update_in_float(std::span<const std::uint8_t> pinned, bool keep_coarse = false);

  /// y = A^-1 r to |r - A y| <= target, all in float, where A is float_matrix(). r, y: per mesh node.
  /// guesses: vectors that y may be near a combination of, per mesh node, zero on pinned ones; tried first.
  FloatCorrection correct_in_float(std::span<const Vec3> r, double target, int max_iterations, std::span<Vec3> y,
                                   std::span<const std::span<const Vec3>> guesses = {});

  std::vector<LevelInfo> levels() const;

 private:
  struct Levels;
  std::unique_ptr<Levels> levels_;
};

/// The table of levels that a report prints: level, nodes, blocks, bytes.
std::string describe(const std::vector<LevelInfo>& levels);

}  // namespace softreel
