#include "core/multigrid/multigrid.h"

#include <optional>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/multigrid/conjugate_gradients.h"
#include "core/multigrid/lattice_hierarchy.h"
#include "core/multigrid/v_cycle.h"

namespace softreel {

struct Multigrid::Levels {
  Levels(const TetMesh& mesh, std::span<const double> element_stiffness, const BlockPattern& pattern,
         const MultigridParams& multigrid_params, const Threads& all_threads)
      : params(multigrid_params),
        threads(all_threads),
        hierarchy(build_lattice_hierarchy(mesh, element_stiffness, pattern, params)),
        float_cycle(hierarchy, params, threads),
        solver(threads) {}

  /// Puts a cycle in double in the place of the float one; false if it is there already or is no better.
  bool use_double_cycle(const BlockMatrixd& matrix) {
    if (double_cycle) return false;
    double_cycle.emplace(hierarchy, params, threads);
    usable = double_cycle->update(matrix, pinned);
    return usable;
  }

  MultigridParams params;
  const Threads& threads;
  LatticeHierarchy hierarchy;
  Cycle<float> float_cycle;
  std::optional<Cycle<double>> double_cycle;  ///< only after the float cycle failed on the present matrix
  std::vector<std::uint8_t> pinned;
  bool usable = false;  ///< the present cycle is positive definite
  ConjugateGradients solver;
};

Multigrid::Multigrid(const TetMesh& mesh, std::span<const double> element_stiffness, const BlockPattern& pattern,
                     const MultigridParams& params, const Threads& threads)
    : levels_(std::make_unique<Levels>(mesh, element_stiffness, pattern, params, threads)) {
  CHECK(params.sweeps >= 1);
  CHECK(params.bottom_nodes >= 1);
}

Multigrid::~Multigrid() = default;
Multigrid::Multigrid(Multigrid&&) noexcept = default;

void Multigrid::update(const BlockMatrixd& matrix, std::span<const std::uint8_t> pinned) {
  levels_->pinned.assign(pinned.begin(), pinned.end());
  levels_->double_cycle.reset();
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
                                          if (levels.double_cycle)
                                            levels.double_cycle->apply(r, r_norm, z);
                                          else
                                            levels.float_cycle.apply(r, r_norm, z);
                                        },
                                        [&] { return levels.use_double_cycle(matrix); }};
    report = levels.solver.solve(matrix, b, x, {tolerance, absolute_tolerance, max_iterations}, preconditioner);
  }
  report.double_cycle = levels.double_cycle.has_value();
  return report;
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
