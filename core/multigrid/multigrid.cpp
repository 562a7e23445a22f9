#include "core/multigrid/multigrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/multigrid/conjugate_gradients.h"
#include "core/multigrid/float_solver.h"
#include "core/multigrid/lattice_hierarchy.h"
#include "core/multigrid/v_cycle.h"

namespace softreel {
namespace {

/// Of |diag(A) y|, in r - A y after a solve in float.
constexpr double kFloatSolveRounding = 1;

/// Above, one sweep takes more than twice the iterations that it takes at 0.3, and two take half as many in about the
/// same time (0.49, bars of 11k and 67k tetrahedra); at 0.47 they take longer.
constexpr double kTwoSweepsPoissonRatio = 0.475;

/// Greatest over least; 1 for none.
double contrast_of(std::span<const double> element_stiffness) {
  if (element_stiffness.empty()) return 1;
  const auto [least, greatest] = std::minmax_element(element_stiffness.begin(), element_stiffness.end());
  return *greatest / *least;
}

}  // namespace

MultigridParams choose_for_body(MultigridParams params, std::span<const double> element_stiffness) {
  const bool contrast = contrast_of(element_stiffness) > params.stiffness_contrast;
  if (params.coarse_cycle == CycleKind::Auto) params.coarse_cycle = contrast ? CycleKind::FullW : CycleKind::W;
  const bool hard = params.poisson_ratio > kTwoSweepsPoissonRatio;
  if (params.sweeps == 0) params.sweeps = hard && params.smoother == SmootherKind::GaussSeidel ? 2 : 1;
  return params;
}

struct Multigrid::Levels {
  Levels(const TetMesh& mesh, std::span<const double> element_stiffness, const BlockPattern& pattern,
         const MultigridParams& multigrid_params, const Threads& all_threads)
      : params(choose_for_body(multigrid_params, element_stiffness)),
        threads(all_threads),
        hierarchy(build_lattice_hierarchy(mesh, element_stiffness, pattern, params)),
        float_cycle(hierarchy, params, threads),
        solver(threads),
        float_solver(float_cycle, threads),
        row_of_node(hierarchy.mesh_nodes.size()) {
    for (std::size_t row = 0; row < row_of_node.size(); ++row)
      row_of_node[static_cast<std::size_t>(hierarchy.mesh_nodes[row])] = static_cast<Index>(row);
  }

  /// Puts a cycle in double in the place of the float one; false if it was tried already or is no better.
  bool use_double_cycle(const BlockMatrixd& matrix) {
    if (double_tried) return false;
    double_tried = true;
    if (!double_cycle) double_cycle.emplace(hierarchy, params, threads);
    in_double = double_cycle->update(matrix, pinned);
    usable = usable || in_double;
    return in_double;
  }

  /// For a new matrix: which of the cycles serves must not depend on those before it.
  void forget_double_cycle() { in_double = double_tried = false; }

  MultigridParams params;
  const Threads& threads;
  LatticeHierarchy hierarchy;
  Cycle<float> float_cycle;
  std::optional<Cycle<double>> double_cycle;  ///< made when the float cycle first fails
  bool in_double = false, double_tried = false;
  std::vector<std::uint8_t> pinned;
  bool usable = false;  ///< the present cycle is positive definite
  ConjugateGradients solver;
  FloatSolver float_solver;
  std::vector<NodeVector<float>> guesses;  ///< of float_solver, in the order of its level
  std::vector<Index> row_of_node;

  double mean_diagonal(std::span<const std::uint8_t> held) const;
  void eliminate(std::span<const std::uint8_t> held);
  double square(std::span<const Vec3> vectors) const;
  void scatter(std::span<const Vec3> vectors, double scale, NodeVector<float>& rows) const;
  double gather_correction(double scale, std::span<Vec3> y) const;
};

/// Mean diagonal entry of the rows of mesh nodes that are not held; 1 if all are.
double Multigrid::Levels::mean_diagonal(std::span<const std::uint8_t> held) const {
  const LatticeLevel& level = hierarchy.levels.front();
  const BlockMatrixf& matrix = float_cycle.finest_matrix();
  double rows = 0;
  for (const std::uint8_t h : held) rows += h == 0 ? 1 : 0;
  const double sum = threads.sum_chunks(level.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    double part = 0;
    for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row) {
      if (held[static_cast<std::size_t>(hierarchy.mesh_nodes[row])] != 0) continue;
      const float* const block = matrix.block(level.diagonal[row]);
      part += static_cast<double>(block[0]) + static_cast<double>(block[4]) + static_cast<double>(block[8]);
    }
    return part;
  });
  return rows > 0 && sum > 0 ? sum / (3 * rows) : 1.0;
}

/// Zeroes rows and columns of held nodes; their diagonal becomes the mean one.
void Multigrid::Levels::eliminate(std::span<const std::uint8_t> held) {
  if (std::find(held.begin(), held.end(), 1) == held.end()) return;
  const auto diagonal = static_cast<float>(mean_diagonal(held));
  const LatticeLevel& level = hierarchy.levels.front();
  BlockMatrixf& matrix = float_cycle.finest_matrix();
  for (std::size_t row = 0; row < row_of_node.size(); ++row) {
    if (held[static_cast<std::size_t>(hierarchy.mesh_nodes[row])] == 0) continue;
    for (std::int64_t b = level.pattern.row_offsets[row]; b < level.pattern.row_offsets[row + 1]; ++b) {
      const Index column = level.pattern.column_indices[static_cast<std::size_t>(b)];
      float* const block = matrix.block(b);
      float* const mirror = matrix.block(level.pattern.find(column, static_cast<Index>(row)));
      std::fill(block, block + 9, 0.0F);
      std::fill(mirror, mirror + 9, 0.0F);
    }
    float* const block = matrix.block(level.diagonal[row]);
    block[0] = block[4] = block[8] = diagonal;
  }
}

/// Sum of squares.
double Multigrid::Levels::square(std::span<const Vec3> vectors) const {
  const auto nodes = static_cast<std::int64_t>(vectors.size());
  return threads.sum_chunks(nodes, kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    double part = 0;
    for (std::int64_t i = begin; i < end; ++i) part += vectors[static_cast<std::size_t>(i)].squaredNorm();
    return part;
  });
}

/// rows = scale * vectors, from mesh nodes to the rows of level 0.
void Multigrid::Levels::scatter(std::span<const Vec3> vectors, double scale, NodeVector<float>& rows) const {
  const auto nodes = static_cast<std::int64_t>(vectors.size());
  threads.for_chunks(nodes, kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t row = begin; row < end; ++row) {
      const Index node = hierarchy.mesh_nodes[static_cast<std::size_t>(row)];
      const Vec3 scaled = scale * vectors[static_cast<std::size_t>(node)];
      lanes(rows, row) = NodeLanes<float>(static_cast<float>(scaled[0]), static_cast<float>(scaled[1]),
                                          static_cast<float>(scaled[2]), 0);
    }
  });
}

/// y = scale * solution, by mesh nodes; returns |diag(A) y|.
double Multigrid::Levels::gather_correction(double scale, std::span<Vec3> y) const {
  const LatticeLevel& level = hierarchy.levels.front();
  const BlockMatrixf& matrix = float_cycle.finest_matrix();
  const double square = threads.sum_chunks(level.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    double part = 0;
    for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row) {
      const Vec3 value =
          scale * lanes(float_solver.solution(), static_cast<std::int64_t>(row)).head<3>().cast<double>();
      const float* const block = matrix.block(level.diagonal[row]);
      part += Vec3(block[0] * value[0], block[4] * value[1], block[8] * value[2]).squaredNorm();
      y[static_cast<std::size_t>(hierarchy.mesh_nodes[row])] = value;
    }
    return part;
  });
  return std::sqrt(square);
}

Multigrid::Multigrid(const TetMesh& mesh, std::span<const double> element_stiffness, const BlockPattern& pattern,
                     const MultigridParams& params, const Threads& threads)
    : levels_(std::make_unique<Levels>(mesh, element_stiffness, pattern, params, threads)) {
  CHECK(params.sweeps >= 0);
  CHECK(params.bottom_nodes >= 1);
}

Multigrid::~Multigrid() = default;
Multigrid::Multigrid(Multigrid&&) noexcept = default;
Multigrid& Multigrid::operator=(Multigrid&&) noexcept = default;

void Multigrid::update(const BlockMatrixd& matrix, std::span<const std::uint8_t> pinned) {
  levels_->pinned.assign(pinned.begin(), pinned.end());
  levels_->forget_double_cycle();
  levels_->usable = levels_->float_cycle.update(matrix, pinned);
  if (!levels_->usable) levels_->use_double_cycle(matrix);
}

SolveReport Multigrid::solve(const BlockMatrixd& matrix, std::span<const Vec3> b, std::span<Vec3> x, double tolerance,
                             double absolute_tolerance, int max_iterations) {
  Levels& levels = *levels_;
  SolveReport report;
  report.status = SolveStatus::Breakdown;
  if (levels.usable) {
    const Preconditioner preconditioner{[&](const NodeVector<double>& r, double r_norm, NodeVector<double>& z) {
                                          if (levels.in_double)
                                            levels.double_cycle->apply(r, r_norm, z);
                                          else
                                            levels.float_cycle.apply(r, r_norm, z);
                                        },
                                        [&] { return levels.use_double_cycle(matrix); }};
    report = levels.solver.solve(matrix, b, x, {tolerance, absolute_tolerance, max_iterations, levels.params.method},
                                 preconditioner);
  }
  report.double_cycle = levels.in_double;
  return report;
}

BlockMatrixf& Multigrid::float_matrix() {
  return levels_->float_cycle.finest_matrix();
}

const std::vector<Index>& Multigrid::row_of_node() const {
  return levels_->row_of_node;
}

bool Multigrid::update_in_float(std::span<const std::uint8_t> pinned, bool keep_coarse) {
  Levels& levels = *levels_;
  levels.usable = false;
  if (levels.hierarchy.levels.size() < 2) return false;
  levels.pinned.assign(pinned.begin(), pinned.end());
  levels.forget_double_cycle();
  levels.eliminate(pinned);
  if (keep_coarse) return levels.float_cycle.update_finest_in_place();
  return levels.float_cycle.update_in_place(pinned);
}

FloatCorrection Multigrid::correct_in_float(std::span<const Vec3> r, double target, int max_iterations,
                                            std::span<Vec3> y, std::span<const std::span<const Vec3>> guesses) {
  Levels& levels = *levels_;
  CHECK(r.size() == levels.row_of_node.size());
  CHECK(y.size() == r.size());
  const double norm = std::sqrt(levels.square(r));
  levels.scatter(r, 1 / norm, levels.float_cycle.right_side());
  levels.guesses.clear();
  for (const std::span<const Vec3> guess : guesses) {
    const double square = levels.square(guess);
    if (!(square > 0) || !std::isfinite(square)) continue;
    levels.guesses.emplace_back(levels.float_cycle.right_side().size());
    levels.scatter(guess, 1 / std::sqrt(square), levels.guesses.back());
  }
  FloatCorrection correction;
  correction.report = levels.float_solver.solve(target / norm, max_iterations, levels.params.method, levels.guesses);
  correction.rounding = kFloatSolveRounding * std::numeric_limits<float>::epsilon() * levels.gather_correction(norm, y);
  return correction;
}

std::vector<LevelInfo> Multigrid::levels() const {
  std::vector<LevelInfo> infos;
  for (std::size_t h = 0; h < levels_->hierarchy.levels.size(); ++h) {
    const LatticeLevel& level = levels_->hierarchy.levels[h];
    const std::int64_t bytes =
        levels_->float_cycle.bytes(h) + (levels_->double_cycle ? levels_->double_cycle->bytes(h) : 0);
    infos.push_back({level.pattern.rows(), level.pattern.blocks(), bytes});
  }
  return infos;
}

std::string describe(const std::vector<LevelInfo>& levels) {
  std::string table = fmt::format("{:>5} {:>10} {:>12} {:>12}\n", "level", "nodes", "blocks", "bytes");
  for (std::size_t h = 0; h < levels.size(); ++h)
    table += fmt::format("{:>5} {:>10} {:>12} {:>12}\n", h, levels[h].nodes, levels[h].blocks, levels[h].bytes);
  return table;
}

}  // namespace softreel
