#include "core/tetmesh/filling/graded_solid.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/tetmesh/filling/mesh_promises.h"
#include "core/tetmesh/filling/waiting_log.h"
#include "core/tetmesh/graded/gap_refinement.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "core/tetmesh/stuffing/mesh_pieces.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

/// Finer edges gain something where they miss an error by less than this share of what was missed before.
constexpr double kMuchNearer = 0.9;

/// What graded filling drops. Open parts have crumbs that no size joins: the inside ends anywhere in their holes.
CrumbLimits graded_crumbs(const Solid& solid) {
  constexpr Index kCrumbTets = 100;  // about eight cells; base edges and finer ones differ too much to go by the size
  constexpr double kCrumbShare = 0.01;
  return solid.has_open_parts() ? CrumbLimits{} : CrumbLimits{kCrumbTets, kCrumbShare};
}

/// A filling of a solid, and what is amiss with it.
struct Try {
  GradedFilling filling;
  WaitingLog lines;   ///< about it
  Index loose = 0;    ///< pieces beside the main one of each solid
  Index tunnels = 0;  ///< that the solid does not have; looked for where a count is wanted
  double missed = 0;  ///< of an error that is not kept: width of the widest gap, m; not of fins and rims, which are
                      ///< open, and which no size brings nearer

  double count() const { return static_cast<double>(filling.stuffed.mesh.tets.size()); }
  double miss_of(double wanted) const { return std::abs(count() / wanted - 1); }
  bool is_more_whole_than(const Try& other) const {
    return std::tie(loose, tunnels) < std::tie(other.loose, other.tunnels);
  }
  double distance_to(const Solid& solid, const Threads& threads) const {
    return measure_deviation(solid.surface, filling.stuffed.mesh, threads).two_way();
  }
};

/// Pieces are told apart only where there are several; then params get to know what they may be.
Index count_loose(const Solid& solid, const GradedFilling& filling, ErrorBudgetParams& params) {
  if (params.triangle_solids.empty()) params.triangle_solids = find_triangle_solids(solid.surface);
  const std::vector<bool> is_main = find_main_pieces(
      filling.stuffed, filling.nearest_triangles, face_connected_pieces(filling.stuffed.mesh), params.triangle_solids);
  return static_cast<Index>(std::count(is_main.begin(), is_main.end(), false));
}

Try try_filling(const Solid& solid, ErrorBudgetParams& params, const std::string& name, const Threads& threads,
                const Log& log) {
  Try made;
  GradedFilling& filling = made.filling;
  const Index pieces = made.lines.fill_or_pass_on(log, [&] {
    filling = fill_graded(solid.surface, params, threads);
    const std::size_t filled = filling.stuffed.mesh.tets.size();
    const Index left = drop_crumbs(filling.stuffed, filling.nearest_triangles, solid.parts, graded_crumbs(solid), name,
                                   made.lines.sink());
    filling.is_kept = filling.is_kept && filling.stuffed.mesh.tets.size() == filled;
    return left;
  });
  if (pieces > 1) made.loose = count_loose(solid, filling, params);
  if (params.error > 0 && filling.widest_gap && !solid.has_open_parts()) made.missed = width_of(*filling.widest_gap);
  return made;
}

/// Edges of one length at the surface that take about so many tetrahedra: of a thick body the inside, which is coarse,
/// takes few.
double even_edge_for(const Solid& solid, double tets) {
  constexpr double kTetsPerCell = 12, kTetsPerSquare = 1.6, kMostPerSquare = 12;
  const double area = solid.parts.area(), volume = solid.parts.volume();
  double edge = std::sqrt(kMostPerSquare * area / tets);
  while (kTetsPerCell * volume / std::pow(edge, 3) + kTetsPerSquare * area / (edge * edge) < tets) edge *= 0.99;
  return edge;
}

/// The count with edges of one length at the surface. Where the widest gaps come first, a wall that is thin all over
/// keeps edges that are too long for it here and there, and is perforated there.
Try try_even_filling(const Solid& solid, ErrorBudgetParams params, const std::string& name, const Threads& threads,
                     const Log& log) {
  constexpr int kSteps = 5;
  constexpr double kCountTolerance = 0.05, kMostChange = 2;
  const double wanted = std::exchange(params.tets, 0);
  params.base_edge = even_edge_for(solid, wanted);
  Try best;
  for (int step = 0; step < kSteps && best.miss_of(wanted) > kCountTolerance; ++step) {
    Try made = try_filling(solid, params, name, threads, log);
    params.base_edge *= std::clamp(std::sqrt(made.count() / wanted), 1 / kMostChange, kMostChange);
    if (made.miss_of(wanted) < best.miss_of(wanted)) best = std::move(made);
  }
  if (best.count() > 0) best.tunnels = count_new_tunnels(best.filling.stuffed, solid);
  return best;
}

/// What falls apart, or lacks a limb, is filled again with finer edges; of what only lacks one the last filling that
/// gained by them is kept. A count that is not whole so is tried with even edges.
GradedFilling fill_whole(const Solid& solid, ErrorBudgetParams params, const std::string& name, const Threads& threads,
                         const Log& log) {
  // Finer edges take more tetrahedra, and a count has no more.
  const int tries = params.base_edge > 0 ? 1 : params.tets > 0 ? 2 : 3;
  Try best = try_filling(solid, params, name, threads, log);
  for (int step = 1; step < tries && (best.loose > 0 || best.missed > params.error); ++step) {
    ++params.finer;
    params.loose_share = 1;
    const bool was_whole = best.loose == 0;
    if (!was_whole) best = {};  // before there is the next
    Try next = try_filling(solid, params, name, threads, log);
    if (was_whole && (next.loose > 0 || !(next.missed < kMuchNearer * best.missed))) break;
    best = std::move(next);
  }
  if (params.tets > 0 && best.count() > 0) best.tunnels = count_new_tunnels(best.filling.stuffed, solid);
  constexpr Index kPerforated = 8;   // fewer tunnels are limbs that grew together, which even edges part less well
  constexpr double kMostOff = 0.25;  // far more than asked is no answer
  if (params.tets > 0 && (best.loose > 0 || best.tunnels >= kPerforated)) {
    Try even = try_even_filling(solid, params, name, threads, log);
    const bool is_answer = even.miss_of(params.tets) < kMostOff && even.is_more_whole_than(best);
    // What is in pieces will be refused; what is only perforated may be the better one.
    if (is_answer && (even.loose < best.loose || even.distance_to(solid, threads) <= best.distance_to(solid, threads)))
      best = std::move(even);
  }
  best.lines.pass_on(log);
  return std::move(best.filling);
}

/// ", least" and where the error is missed most; nothing where only what was dropped missed it.
std::string least_reached(const Solid& solid, const GradedFilling& filling) {
  if (!filling.widest_gap) return "";
  const Vec3& p = filling.widest_gap->on_surface;
  const TriangleTree tree(solid.surface.positions, solid.surface.triangles);
  const SurfacePart& part = solid.parts.parts[at(solid.parts.triangle_parts[at(tree.nearest(p).triangle)])];
  return fmt::format(", least {} at ({:.4g}, {:.4g}, {:.4g})", part.name, p[0], p[1], p[2]);
}

}  // namespace

GradedSolid grade_solid(const Solid& solid, const ErrorBudgetParams& params, const std::string& name,
                        const Threads& threads, const Log& log, StageTimes& times) {
  GradedFilling filling = [&] {
    const ScopedStage stage(times, "tetrahedralize/lattice");
    return fill_whole(solid, params, name, threads, log);
  }();
  StuffedMesh& stuffed = filling.stuffed;
  stuffed.mesh.lattice.spacing = filling.finest_edge;  // what is too thin is judged by that
  require_all_parts(stuffed, filling.nearest_triangles, solid.parts, name, log);
  stuffed.mesh.lattice = {};  // none of one size: the hierarchy finds coarse lattices of its own, and converges better
  order_nodes(stuffed);
  if (params.error > 0 && !filling.is_kept) {
    const ScopedStage stage(times, "tetrahedralize/check");
    const double reached = measure_deviation(solid.surface, stuffed.mesh, threads).two_way();
    if (reached > params.error)
      log.warn(fmt::format(
          "body '{}': the tetrahedra keep to {:.4g} m of the surface, not to error = {:.4g} m: even edges of {:.4g} m "
          "do not reach all of it{}. Accepted: this mesh, as it is. Close or thicken what is thin.",
          name, reached, params.error, filling.finest_edge, least_reached(solid, filling)));
  }
  return {std::move(stuffed), filling.finest_edge};
}

}  // namespace softreel
