#include "core/tetmesh/tetrahedralize.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/tetmesh/boundary_fit.h"
#include "core/tetmesh/boundary_mending.h"
#include "core/tetmesh/error_budget.h"
#include "core/tetmesh/graded_stuffing.h"
#include "core/tetmesh/mesh_pieces.h"
#include "core/tetmesh/sheet_shells.h"
#include "core/tetmesh/tet_quality.h"
#include "core/tetmesh/thin_parts.h"

namespace softreel {
namespace {

/// More than this does not fit the 32-bit indices of what comes later.
constexpr double kMaxTets = 1.5e8;

/// Tetrahedra of a lattice: 12 per cubic cell inside, and so many per square cell of the surface.
constexpr double kTetsPerCell = 12.0, kTetsPerSquare = 1.6;

/// How far the number of elements may be from the wanted one.
constexpr double kCountTolerance = 0.05;

/// One body on its way; borrowed from the caller of tetrahedralize.
struct Job {
  const SurfaceMesh& surface;
  const SurfaceParts& parts;
  const Bounds& box;
  const std::string& name;
  const Threads& threads;
  const Log& log;
  StageTimes& times;
};

double predicted_tets(double volume, double area, double edge) {
  return kTetsPerCell * volume / (edge * edge * edge) + kTetsPerSquare * area / (edge * edge);
}

void require_size(const Job& job, double edge) {
  const double reach = job.box.size().maxCoeff() / edge;
  const double tets = predicted_tets(job.parts.volume(), job.parts.area(), edge);
  if (reach < 0.45 * kMaxLatticeCoordinate && tets < kMaxTets) return;
  throw input_error(fmt::format(
      "body '{}': edge = {:.4g} m makes about {:.3g} tetrahedra in a box {:.4g} edges long. Accepted: at most {:.2g} "
      "tetrahedra and {:.2g} edges. Use a larger edge, or check the unit of the file (fit sets the height in m).",
      job.name, edge, tets, reach, kMaxTets, 0.45 * kMaxLatticeCoordinate));
}

/// Stuffs, mends and cleans; no promises checked yet.
StuffedMesh fill_surface(const Job& job, double edge, const Vec3& shift = Vec3::Zero()) {
  require_size(job, edge);
  const LatticeFrame frame{job.box.center() + edge * shift, edge};
  SurfaceDistance distance = [&] {
    const ScopedStage stage(job.times, "tetrahedralize/distance");
    return measure_distance(job.surface.positions, job.surface.triangles, frame, job.threads);
  }();
  const ScopedStage stage(job.times, "tetrahedralize/lattice");
  if (const Index taken_in = bridge_thin_parts(distance, job.surface, job.parts); taken_in > 0)
    job.log.info(
        fmt::format("body '{}': what is thinner than the lattice was thickened to about its edge ({:.4g} m) at {} "
                    "nodes, so that it holds together. A smaller edge or more tets follow the surface there.",
                    job.name, edge, taken_in));
  StuffedMesh stuffed = stuff_isosurface(distance.lattice, job.threads);
  const BoundaryMending mending = mend_boundary(stuffed);
  if (mending.copied_nodes > 0 || mending.removed_tets > 0)
    job.log.info(
        fmt::format("body '{}': {} nodes where parts touched at a vertex or edge were parted, {} tetrahedra where "
                    "the body touched itself were removed",
                    job.name, mending.copied_nodes, mending.removed_tets));
  drop_crumbs(stuffed, distance, job.parts, job.name, job.log);
  require_all_parts(stuffed, distance, job.parts, job.name, job.log);
  order_nodes(stuffed);
  return stuffed;
}

/// Dihedral angles that a mesh promises, degrees.
struct AngleBounds {
  double min = kMinDihedral, max = kMaxDihedral;
};

/// The promises of the header, tested on every mesh.
void require_quality(const Job& job, const TetMesh& mesh, const AngleBounds& bounds) {
  const ScopedStage stage(job.times, "tetrahedralize/check");
  const auto nodes = static_cast<Index>(mesh.nodes.size());
  for (const Tet& tet : mesh.tets)
    for (const Index node : tet) {
      CHECK(node >= 0);
      CHECK(node < nodes);
    }
  const TetQuality quality = measure_quality(mesh, job.threads);
  if (quality.min_volume > 0 && quality.min_dihedral >= bounds.min && quality.max_dihedral <= bounds.max) return;
  throw work_error(fmt::format(
      "body '{}': a tetrahedron is worse than promised: volume {:.3g} m^3 (element {}), dihedral angles {:.4g} to "
      "{:.4g} "
      "degrees (elements {}, {}). Accepted: positive volume, {} to {} degrees. The body may be too far from the origin "
      "for its size; move it nearer, or use another edge length.",
      job.name, quality.min_volume, quality.min_volume_tet, quality.min_dihedral, quality.max_dihedral,
      quality.min_dihedral_tet, quality.max_dihedral_tet, bounds.min, bounds.max));
}

/// The edge that gives `tets` by the prediction; it falls monotonously with the edge, so halving finds it.
double edge_for_tets(double volume, double area, double tets) {
  double low = 0, high = std::sqrt((kTetsPerSquare * area + kTetsPerCell * std::pow(volume, 2.0 / 3.0)) / tets) * 8.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (predicted_tets(volume, area, middle) > tets ? low : high) = middle;
  }
  return high;
}

/// Lines that wait until it is known whether their mesh is the one that is kept.
struct WaitingLog {
  std::vector<std::string> infos, warnings;

  Log sink() {
    return {[this](const std::string& line) { infos.push_back(line); },
            [this](const std::string& line) { warnings.push_back(line); }};
  }
  void pass_on(const Log& log) const {
    for (const std::string& line : infos) log.info(line);
    for (const std::string& line : warnings) log.warn(line);
  }
};

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

/// Predicts an edge, fills, and corrects it by the cube root of the count's error until that is within 5 %.
StuffedMesh fill_with_count(const Job& job, double wanted) {
  double edge = edge_for_tets(job.parts.volume(), job.parts.area(), wanted);
  StuffedMesh best;
  WaitingLog best_lines;
  double best_error = 1e300;
  constexpr int kSteps = 6;
  for (int step = 0; step < kSteps; ++step) {
    WaitingLog lines;
    const Log log = lines.sink();
    StuffedMesh stuffed = fill_surface({job.surface, job.parts, job.box, job.name, job.threads, log, job.times}, edge,
                                       lattice_shift(std::max(0, step - 1)));
    const auto count = static_cast<double>(stuffed.mesh.tets.size());
    const double error = std::abs(count / wanted - 1.0);
    if (error < best_error) {
      best_error = error;
      best = std::move(stuffed);
      best_lines = lines;
    }
    if (best_error <= kCountTolerance) break;
    edge *= std::cbrt(std::max(count, 1.0) / wanted);
  }
  best_lines.pass_on(job.log);
  if (!best.mesh.tets.empty()) warn_of_count(job, wanted, best.mesh.tets.size());
  return best;
}

/// Fills with graded sizes; says where an error budget could not be kept.
StuffedMesh fill_with_grades(const Job& job, const TetrahedralizeParams& params) {
  if (params.edge > 0) require_size(job, params.edge);
  if (params.error > 0) require_size(job, 12 * params.error);
  GradedFilling filling = [&] {
    const ScopedStage stage(job.times, "tetrahedralize/lattice");
    return fill_graded(job.surface,
                       {.error = params.error, .tets = static_cast<double>(params.tets), .base_edge = params.edge},
                       job.threads);
  }();
  StuffedMesh& stuffed = filling.stuffed;
  if (stuffed.mesh.tets.empty()) return std::move(stuffed);
  const std::size_t filled = stuffed.mesh.tets.size();
  stuffed.mesh.lattice.spacing = filling.finest_edge;  // what is small, and what is too thin, is judged by that
  drop_crumbs(stuffed, filling.distance, job.parts, job.name, job.log);
  require_all_parts(stuffed, filling.distance, job.parts, job.name, job.log);
  stuffed.mesh.lattice = {};  // none of one size: the hierarchy finds coarse lattices of its own, and converges better
  order_nodes(stuffed);
  if (params.tets > 0) warn_of_count(job, static_cast<double>(params.tets), stuffed.mesh.tets.size());
  if (params.error == 0 || (filling.is_kept && stuffed.mesh.tets.size() == filled)) return std::move(stuffed);
  const ScopedStage stage(job.times, "tetrahedralize/check");
  if (const double reached = measure_deviation(job.surface, stuffed.mesh, job.threads).two_way();
      reached > params.error)
    job.log.warn(
        fmt::format("body '{}': the tetrahedra keep to {:.4g} m of the surface, not to error = {:.4g} m: even edges of "
                    "{:.4g} m do not reach all of it. Accepted: this mesh, as it is. Close or thicken what is thin.",
                    job.name, reached, params.error, filling.finest_edge));
  return std::move(stuffed);
}

void require_params(const SurfaceMesh& surface, const TetrahedralizeParams& params, const std::string& name) {
  if ((params.edge > 0) + (params.tets > 0) + (params.error > 0) != 1)
    throw input_error(
        fmt::format("body '{}': edge = {} m, tets = {}, error = {} m: exactly one of the sizes must be set. Accepted: "
                    "one above 0. Give tets (for example 20000) and leave the others out.",
                    name, params.edge, params.tets, params.error));
  if (surface.triangles.empty())
    throw input_error(
        fmt::format("body '{}': its surface has no triangles, so there is nothing to fill. Accepted: a "
                    "surface that encloses a volume. Check the mesh file.",
                    name));
}

/// An open sheet has no inside; what its winding numbers would make of it is nobody's wish.
void require_inside(const Job& job) {
  const Index sheet = find_sheet(job.surface, job.parts);
  if (sheet < 0) return;
  const SurfacePart& part = job.parts.parts[static_cast<std::size_t>(sheet)];
  const Vec3 center = part.box.center();
  throw input_error(fmt::format(
      "body '{}': {} near ({:.4g}, {:.4g}, {:.4g}) is an open sheet: it encloses nothing. Accepted: a "
      "surface that encloses a volume, or an open sheet with a thickness. Set thickness, close the surface, "
      "or take the part out of it.",
      job.name, part.name, center[0], center[1], center[2]));
}

/// Leaves out the vertices that no triangle uses: what looks at vertices is not to see them.
void drop_unused_vertices(SurfaceMesh& mesh) {
  std::vector<Index> number(mesh.positions.size(), -1);
  for (const Triangle& triangle : mesh.triangles)
    for (const Index v : triangle) number[static_cast<std::size_t>(v)] = 0;
  std::vector<Vec3> used;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<Index>(used.size());
    used.push_back(mesh.positions[v]);
  }
  const auto renumber = [&](Index& v) { v = number[static_cast<std::size_t>(v)]; };
  for (Triangle& triangle : mesh.triangles) std::for_each(triangle.begin(), triangle.end(), renumber);
  for (VertexGroup& group : mesh.groups) {
    std::for_each(group.vertices.begin(), group.vertices.end(), renumber);
    std::erase(group.vertices, -1);
  }
  mesh.positions = std::move(used);
}

/// What is filled: the surface's used vertices, joined ones in one place, and its open parts thickened.
SurfaceMesh prepare(const SurfaceMesh& surface, double thickness, const std::string& name, const Log& log) {
  SurfaceMesh prepared;
  prepared.positions = surface.positions;
  prepared.triangles = surface.triangles;
  prepared.groups = surface.groups;
  for (std::size_t v = 0; v < surface.joined.size(); ++v)
    prepared.positions[v] = surface.positions[static_cast<std::size_t>(surface.joined[v])];
  if (thickness > 0)
    if (const std::int64_t open = thicken_sheets(prepared, find_parts(prepared), thickness); open > 0)
      log.info(
          fmt::format("body '{}': {} triangles of open parts became sheets {:.4g} m thick", name, open, thickness));
  drop_unused_vertices(prepared);
  return prepared;
}

/// A flat surface has no volume with any lattice, and a size by count would ask for a lattice without end.
void require_volume(const Job& job) {
  constexpr double kFlat = 1e-9;  // of the area to the power of 3/2; a ball has 0.094
  double volume = 0, area = 0;
  bool open = false;
  for (const SurfacePart& part : job.parts.parts) {
    volume += std::abs(part.volume);
    area += part.area;
    open = open || part.open;
  }
  if (volume > kFlat * std::pow(area, 1.5)) return;
  throw input_error(
      fmt::format("body '{}': its surface is {}, so it encloses no volume. Accepted: a surface that encloses a volume, "
                  "or an open sheet with a thickness. {}.",
                  job.name, area > 0 ? "flat" : "no more than points and lines",
                  open && area > 0 ? "Set thickness" : "Check the mesh file"));
}

}  // namespace

TetMesh tetrahedralize(const SurfaceMesh& surface, const TetrahedralizeParams& params, const std::string& name,
                       const Threads& threads, const Log& log, StageTimes& times) {
  require_params(surface, params, name);
  const SurfaceMesh prepared = prepare(surface, params.thickness, name, log);
  const SurfaceParts parts = find_parts(prepared);
  const Bounds box = used_bounds(prepared);
  const Job job{prepared, parts, box, name, threads, log, times};
  require_volume(job);
  require_inside(job);
  const bool graded = params.graded || params.error > 0;
  StuffedMesh stuffed = graded            ? fill_with_grades(job, params)
                        : params.edge > 0 ? fill_surface(job, params.edge)
                                          : fill_with_count(job, static_cast<double>(params.tets));
  if (stuffed.mesh.tets.empty())
    throw input_error(
        fmt::format("body '{}': its surface encloses no volume that a lattice with edge {:.4g} m can fill. "
                    "Accepted: a surface that encloses a volume. Close or thicken it, or use a smaller edge.",
                    name, stuffed.mesh.lattice.spacing));
  if (!graded) {
    const ScopedStage stage(times, "tetrahedralize/fit");
    fit_boundary(stuffed, prepared, {}, threads);
  }
  require_quality(job, stuffed.mesh, graded ? AngleBounds{kMinGradedDihedral, kMaxGradedDihedral} : AngleBounds{});
  return std::move(stuffed.mesh);
}

}  // namespace softreel
