#include "core/tetmesh/filling/tetrahedralize.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <tuple>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/tetmesh/boundary/boundary_fit.h"
#include "core/tetmesh/filling/graded_solid.h"
#include "core/tetmesh/filling/mesh_promises.h"
#include "core/tetmesh/filling/solids.h"
#include "core/tetmesh/filling/surface_preparation.h"
#include "core/tetmesh/filling/touching_solids.h"
#include "core/tetmesh/filling/waiting_log.h"
#include "core/tetmesh/graded/graded_stuffing.h"
#include "core/tetmesh/improvement/angle_improvement.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "core/tetmesh/stuffing/boundary_mending.h"
#include "core/tetmesh/stuffing/mesh_pieces.h"
#include "core/tetmesh/stuffing/thin_parts.h"

namespace softreel {
namespace {

/// More than this does not fit the 32-bit indices of what comes later.
constexpr double kMaxTets = 1.5e8;

/// Tetrahedra of a lattice: 12 per cubic cell inside, and so many per square cell of the surface.
constexpr double kTetsPerCell = 12.0, kTetsPerSquare = 1.6, kEmbeddedTetsPerSquare = 5.0;

/// Shift of the lattice in embedded mode, edges: the faces of boxes are not to lie in those of tetrahedra.
const Vec3 kOffGrid(0.1237, 0.3711, 0.2339);

/// What meshes promise; whole lattice tetrahedra have 60 and 90 degrees, but for round-off.
constexpr AngleBounds kUniformAngles{kMinDihedral, kMaxDihedral}, kGradedAngles{kMinGradedDihedral, kMaxGradedDihedral},
    kCellAngles{59.99, 90.01};

/// How far the number of elements may be from the wanted one.
constexpr double kCountTolerance = 0.05;

/// One body on its way; borrowed from the caller of tetrahedralize.
struct Job {
  const PreparedSurface& prepared;
  const std::vector<Solid>& solids;  ///< of the prepared surface; conforming mode
  const TetrahedralizeParams& params;
  const std::string& name;
  const Threads& threads;
  const Log& log;
  StageTimes& times;

  bool is_graded() const { return params.graded || params.error > 0; }
  bool is_embedded() const { return params.mode == TetMode::Embedded; }
  double tets_per_square() const { return is_embedded() ? kEmbeddedTetsPerSquare : kTetsPerSquare; }
};

/// The tetrahedra of a body on their way: of each solid apart, or of all in embedded mode.
struct Filling {
  std::vector<StuffedMesh> meshes;
  double edge = 0;  ///< the finest, m

  std::size_t tets() const {
    std::size_t sum = 0;
    for (const StuffedMesh& stuffed : meshes) sum += stuffed.mesh.tets.size();
    return sum;
  }
};

double predicted_tets(const Job& job, double edge) {
  return kTetsPerCell * job.prepared.parts.volume() / (edge * edge * edge) +
         job.tets_per_square() * job.prepared.parts.area() / (edge * edge);
}

void require_size(const Job& job, double edge) {
  const double reach = job.prepared.box.size().maxCoeff() / edge;
  const double tets = predicted_tets(job, edge);
  if (reach < 0.45 * kMaxLatticeCoordinate && tets < kMaxTets) return;
  throw input_error(fmt::format(
      "body '{}': edge = {:.4g} m makes about {:.3g} tetrahedra in a box {:.4g} edges long. Accepted: at most {:.2g} "
      "tetrahedra and {:.2g} edges. Use a larger edge, or check the unit of the file (fit sets the height in m).",
      job.name, edge, tets, reach, kMaxTets, 0.45 * kMaxLatticeCoordinate));
}

/// Covers the surface with whole lattice tetrahedra.
StuffedMesh cover_surface(const Job& job, double edge, const Vec3& shift) {
  const ScopedStage stage(job.times, "tetrahedralize/lattice");
  const PreparedSurface& prepared = job.prepared;
  const LatticeFrame frame{prepared.box.center() + edge * (shift + kOffGrid), edge};
  EmbeddedLattice cover = cover_with_lattice(prepared.surface, prepared.parts, frame, prepared.carried, job.threads);
  job.log.info(fmt::format(
      "body '{}': embedded in {} whole lattice tetrahedra, {} of them cut by the surface, {} of those copies "
      "where parts of the body lie in one",
      job.name, cover.mesh.tets.size(), cover.cut_cells + cover.copies, cover.copies));
  if (cover.branches > 0)
    job.log.info(fmt::format("body '{}': at {} places limbs side by side in one lattice tetrahedron join", job.name,
                             cover.branches));
  return {std::move(cover.mesh), {}, {}};
}

/// Where solids touch, what is thin is thickened across.
void warn_of_fused(const Job& job, const Solid& solid, const TetMesh& mesh) {
  if (solid.has_open_parts()) return;
  const Index wanted = count_solids(solid.surface), pieces = count_pieces(mesh);
  if (pieces > 0 && pieces < wanted)
    job.log.warn(
        fmt::format("body '{}': {} solids that touch in {} became {}: what joins them was thickened to about the edge. "
                    "Accepted: this mesh, as it is. Move them apart, or use mode = \"embedded\" or error.",
                    job.name, wanted, solid.parts.parts.front().place(), pieces));
}

SurfaceDistance measure_solid(const Job& job, const Solid& solid, const LatticeFrame& frame) {
  const ScopedStage stage(job.times, "tetrahedralize/distance");
  return measure_distance(solid.surface.positions, solid.surface.triangles, frame, job.threads);
}

/// Stuffs one solid; no promises checked yet. bridged: of these parts thin ones are kept in one piece each.
StuffedMesh stuff_parts(const Job& job, const Solid& solid, SurfaceDistance distance, const SurfaceParts& bridged) {
  const ScopedStage stage(job.times, "tetrahedralize/lattice");
  const Index taken_in = bridge_thin_parts(distance, solid.surface, bridged);
  if (taken_in > 0)
    job.log.info(
        fmt::format("body '{}': what is thinner than the lattice was thickened to about its edge ({:.4g} m) at {} "
                    "nodes, so that it holds together. A smaller edge or more tets follow the surface there.",
                    job.name, distance.lattice.frame.spacing, taken_in));
  StuffedMesh stuffed = stuff_isosurface(distance.lattice, job.threads);
  const BoundaryMending mending = mend_boundary(stuffed);
  if (mending.copied_nodes > 0 || mending.removed_tets > 0)
    job.log.info(
        fmt::format("body '{}': {} nodes where parts touched at a vertex or edge were parted, {} tetrahedra where "
                    "the body touched itself were removed",
                    job.name, mending.copied_nodes, mending.removed_tets));
  drop_crumbs(stuffed, distance.nearest_triangles, solid.parts, {}, job.name, job.log);
  require_all_parts(stuffed, distance.nearest_triangles, solid.parts, job.name, job.log);
  if (taken_in > 0) warn_of_fused(job, solid, stuffed.mesh);
  order_nodes(stuffed);
  return stuffed;
}

/// Stuffs one solid part by part, so that those that only come near each other stay apart; or, where that leaves a thin
/// one hanging loose beside the one that it grows out of, all parts as one.
StuffedMesh stuff_solid(const Job& job, const Solid& solid, const LatticeFrame& frame) {
  if (solid.parts.parts.size() <= 1 || solid.has_open_parts())
    return stuff_parts(job, solid, measure_solid(job, solid, frame), solid.parts);
  const SurfaceDistance distance = measure_solid(job, solid, frame);
  WaitingLog lines;
  const Log log = lines.sink();
  const Job waiting{job.prepared, job.solids, job.params, job.name, job.threads, log, job.times};
  const auto stuff = [&](const SurfaceParts& bridged) {
    return lines.fill_or_pass_on(job.log, [&] { return stuff_parts(waiting, solid, distance, bridged); });
  };
  StuffedMesh stuffed = stuff(solid.parts);
  if (!is_whole(stuffed.mesh, solid.surface)) {
    lines = {};
    stuffed = {};
    stuffed = stuff({{SurfacePart{}}, std::vector<Index>(solid.surface.triangles.size(), 0)});
  }
  lines.pass_on(job.log);
  return stuffed;
}

/// Fills with one edge length.
Filling fill_with_edge(const Job& job, double edge, const Vec3& shift = Vec3::Zero()) {
  require_size(job, edge);
  Filling filling;
  filling.edge = edge;
  if (job.is_embedded()) {
    filling.meshes.push_back(cover_surface(job, edge, shift));
    return filling;
  }
  const LatticeFrame frame{job.prepared.box.center() + edge * shift, edge};
  for (const Solid& solid : job.solids) filling.meshes.push_back(stuff_solid(job, solid, frame));
  return filling;
}

/// The edge that gives `tets` by the prediction; it falls monotonously with the edge, so halving finds it.
double edge_for_tets(const Job& job, double tets) {
  const SurfaceParts& parts = job.prepared.parts;
  double low = 0,
         high = std::sqrt((job.tets_per_square() * parts.area() + kTetsPerCell * std::pow(parts.volume(), 2.0 / 3.0)) /
                          tets) *
                8.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (predicted_tets(job, middle) > tets ? low : high) = middle;
  }
  return high;
}

/// Shift of the lattice, in edges: points that fill the cube evenly (the plastic number's additive recurrence). A body
/// that is symmetric about its centre changes its count in jumps while the lattice is centred on it.
Vec3 lattice_shift(int step) {
  constexpr double kShares[] = {0.8191725134, 0.6710436067, 0.5497004779};
  Vec3 shift;
  for (int k = 0; k < 3; ++k) shift[k] = step * kShares[k] - std::floor(step * kShares[k]);
  return shift;
}

void warn_of_count(const Job& job, double wanted, std::size_t count) {
  if (std::abs(static_cast<double>(count) / wanted - 1) <= kCountTolerance) return;
  job.log.warn(
      fmt::format("body '{}': {} tetrahedra instead of tets = {}: so few follow the lattice in jumps. Set edge "
                  "instead for a chosen size.",
                  job.name, count, wanted));
}

/// How far a filling is from what is wanted; what comes first counts more.
struct Fault {
  double missed = 1e300;  ///< of the count, beyond what is tolerated
  Index tunnels = 0;      ///< of thin walls; looked for where small counts let lattices be tried
  double error = 1e300;   ///< of the count

  auto operator<=>(const Fault&) const = default;
};

/// Predicts an edge, fills, and corrects it by the cube root of the count's error until that is within 5 %. Small
/// counts go in jumps from lattice to lattice, and take little time: of them more lattices are tried, also where one
/// perforates a thin wall.
Filling fill_with_count(const Job& job, double wanted) {
  double edge = edge_for_tets(job, wanted);
  Filling best;
  WaitingLog best_lines;
  Fault least;
  std::exception_ptr refused;
  int refusals = 0, perforated = 0;
  constexpr int kSteps = 6, kStepsOfSmall = 24, kMostRefusals = 2, kMostPerforated = 4;
  constexpr double kMostOff = 0.25, kSmall = 50000;
  const int steps = wanted <= kSmall ? kStepsOfSmall : kSteps;
  for (int step = 0; step < steps; ++step) {
    WaitingLog lines;
    const Log log = lines.sink();
    require_size(job, edge);
    Filling filling;
    try {  // the second step corrects the edge on the same lattice; all others, and after a refusal, have another
      filling = fill_with_edge({job.prepared, job.solids, job.params, job.name, job.threads, log, job.times}, edge,
                               lattice_shift(std::max(0, step - 1) + refusals));
    } catch (const Error&) {  // a part that one lattice misses another may meet
      if (!refused) refused = std::current_exception();
      if (++refusals >= kMostRefusals && !(least.error < kMostOff)) break;
      continue;
    }
    const auto count = static_cast<double>(filling.tets());
    Fault fault{0, 0, std::abs(count / wanted - 1.0)};
    fault.missed = std::max(fault.error - kCountTolerance, 0.0);
    if (wanted <= kSmall && fault.missed == 0 && !job.is_embedded())
      for (std::size_t s = 0; s < filling.meshes.size(); ++s)
        fault.tunnels += count_new_tunnels(filling.meshes[s], job.solids[s]);
    if (fault < least) {
      least = fault;
      best = std::move(filling);
      best_lines = lines;
    }
    if (least.missed == 0 && (least.tunnels == 0 || ++perforated > kMostPerforated)) break;
    edge *= std::cbrt(std::max(count, 1.0) / wanted);
  }
  if (refused && !(least.error < kMostOff)) std::rethrow_exception(refused);  // far more than asked is no answer
  best_lines.pass_on(job.log);
  if (best.tets() > 0) warn_of_count(job, wanted, best.tets());
  return best;
}

/// Fills with graded sizes. A count is shared out by the solids' areas.
Filling fill_with_grades(const Job& job) {
  const TetrahedralizeParams& params = job.params;
  if (params.edge > 0) require_size(job, params.edge);
  if (params.error > 0) require_size(job, 12 * params.error);
  if (params.tets > 0) require_size(job, edge_for_tets(job, static_cast<double>(params.tets)));
  double area = 0;
  for (const Solid& solid : job.solids) area += solid.parts.area();
  Filling filling;
  for (const Solid& solid : job.solids) {
    const double tets = static_cast<double>(params.tets) * solid.parts.area() / area;
    GradedSolid graded = grade_solid(solid, {.error = params.error, .tets = tets, .base_edge = params.edge}, job.name,
                                     job.threads, job.log, job.times);
    filling.edge = std::max(filling.edge, graded.finest_edge);
    filling.meshes.push_back(std::move(graded.stuffed));
  }
  if (params.tets > 0 && filling.tets() > 0) warn_of_count(job, static_cast<double>(params.tets), filling.tets());
  return filling;
}

void require_params(const TetrahedralizeParams& params, const std::string& name) {
  if ((params.edge > 0) + (params.tets > 0) + (params.error > 0) != 1)
    throw input_error(
        fmt::format("body '{}': edge = {} m, tets = {}, error = {} m: exactly one of the sizes must be set. Accepted: "
                    "one above 0. Give tets (for example 20000) and leave the others out.",
                    name, params.edge, params.tets, params.error));
  for (const auto& [field, is_set, reason] :
       {std::tuple("graded", params.graded, "have one size"),
        std::tuple("optimize", params.optimize, "have angles of 60 and 90 degrees")})
    if (is_set && params.mode == TetMode::Embedded)
      throw input_error(fmt::format(
          "body '{0}': {1} = true with mode = \"embedded\": whole lattice tetrahedra {2}. Accepted: {1} with "
          "conforming. Leave one of the two out.",
          name, field, reason));
  if (params.error > 0 && params.mode == TetMode::Embedded)
    throw input_error(
        fmt::format("body '{}': error = {} m with mode = \"embedded\": whole lattice tetrahedra do not follow the "
                    "surface at all. Accepted: tets or edge with embedded, error with conforming. Set tets instead.",
                    name, params.error));
}

/// Solids with a volume; of the others, parts by parts, is said that nothing can be filled there, and of those that
/// touch that they are apart.
std::vector<Solid> take_solids(const PreparedSurface& prepared, const std::string& name, const Log& log) {
  std::vector<Solid> solids =
      split_solids(prepared.surface, prepared.parts, find_solids(prepared.surface, prepared.parts));
  std::erase_if(solids, [&](const Solid& solid) {
    const std::vector<SurfacePart>& parts = solid.parts.parts;
    const bool flat = std::all_of(parts.begin(), parts.end(), [](const SurfacePart& part) { return part.is_flat(); });
    for (const SurfacePart& part : parts)
      if (flat) log.warn(fmt::format("body '{}': {} encloses no volume and has no tetrahedra", name, part.place()));
    return flat;
  });
  warn_of_touching(solids, name, log);
  return solids;
}

/// Draws each solid's boundary to its own surface, betters its angles if asked, and looks whether it is one piece.
void finish_solids(const Job& job, Filling& filling) {
  for (std::size_t s = 0; s < filling.meshes.size(); ++s) {
    const Solid& solid = job.solids[s];
    StuffedMesh& stuffed = filling.meshes[s];
    if (!job.is_graded()) {
      const ScopedStage stage(job.times, "tetrahedralize/fit");
      fit_boundary(stuffed, solid.surface, {}, job.threads);
    }
    if (job.params.optimize) {
      const ScopedStage stage(job.times, "tetrahedralize/optimize");
      const AngleImprovement done = improve_angles(stuffed.mesh, &solid.surface, {}, job.threads);
      job.log.info(fmt::format("body '{}': {}", job.name, describe(done)));
    }
    const ScopedStage stage(job.times, "tetrahedralize/check");
    require_whole(stuffed.mesh, solid.surface, filling.edge, solid.thinnest_part().place(), job.name);
    warn_of_tunnels(stuffed, solid, job.name, job.log);
    if (job.params.error > 0) continue;  // it says itself what it misses
    if (job.is_graded()) require_most_of(stuffed.mesh, solid, job.name, job.threads);
    warn_of_volume(stuffed.mesh, solid, job.name, job.threads, job.log);
  }
}

/// The meshes one after the other; they lie on one lattice, or on none.
TetMesh join_meshes(std::vector<StuffedMesh>& meshes) {
  TetMesh joined = std::move(meshes.front().mesh);
  for (std::size_t m = 1; m < meshes.size(); ++m) {
    const auto first = static_cast<Index>(joined.nodes.size());
    const TetMesh& mesh = meshes[m].mesh;
    joined.nodes.insert(joined.nodes.end(), mesh.nodes.begin(), mesh.nodes.end());
    for (const Tet& tet : mesh.tets)
      joined.tets.push_back({tet[0] + first, tet[1] + first, tet[2] + first, tet[3] + first});
  }
  return joined;
}

Filling fill(const Job& job) {
  const TetrahedralizeParams& params = job.params;
  if (job.is_graded()) return fill_with_grades(job);
  return params.edge > 0 ? fill_with_edge(job, params.edge) : fill_with_count(job, static_cast<double>(params.tets));
}

}  // namespace

TetMesh tetrahedralize(const SurfaceMesh& surface, const TetrahedralizeParams& params, const std::string& name,
                       const Threads& threads, const Log& log, StageTimes& times) {
  require_params(params, name);
  const bool embedded = params.mode == TetMode::Embedded;
  PreparedSurface prepared = prepare_surface(surface, {params.thickness, embedded}, name, log);
  std::vector<Solid> solids;
  if (!embedded)
    solids = take_solids(prepared, name, log);
  else if (prepared.parts.parts.size() > 1)  // covered in one go, and as much apart
    warn_of_touching(split_solids(prepared.surface, prepared.parts, find_solids(prepared.surface, prepared.parts)),
                     name, log);
  if (!embedded && solids.empty())
    throw input_error(fmt::format(
        "body '{}': all of its surface is flat, and encloses no volume. Accepted: a surface that encloses a volume. "
        "Give it a thickness, or close what is open.",
        name));
  if (!embedded) {  // the solids have it all
    prepared.surface = {};
    std::vector<CarriedPoint>().swap(prepared.carried);
    std::vector<Index>().swap(prepared.parts.triangle_parts);
  }
  const Job job{prepared, solids, params, name, threads, log, times};
  Filling filling = fill(job);
  if (filling.tets() == 0)
    throw input_error(
        fmt::format("body '{}': its surface encloses no volume that a lattice with edge {:.4g} m can fill. "
                    "Accepted: a surface that encloses a volume. Close or thicken it, or use a smaller edge.",
                    name, filling.edge));
  if (!embedded) finish_solids(job, filling);
  TetMesh mesh = join_meshes(filling.meshes);
  const ScopedStage stage(times, "tetrahedralize/check");
  require_quality(mesh, embedded ? kCellAngles : job.is_graded() ? kGradedAngles : kUniformAngles, name, threads);
  embedded ? say_joined_limbs(mesh, name, log) : require_manifold(mesh, name);
  return mesh;
}

}  // namespace softreel
