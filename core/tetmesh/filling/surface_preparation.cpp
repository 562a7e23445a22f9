#include "core/tetmesh/filling/surface_preparation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/tetmesh/surface/sheet_shells.h"

namespace softreel {
namespace {

/// One vertex for each place, so that what sorts vertices by place does so once.
void weld(SurfaceMesh& mesh) {
  const std::vector<Index> first = weld_positions(mesh.positions);
  for (Triangle& triangle : mesh.triangles)
    for (Index& v : triangle) v = first[static_cast<std::size_t>(v)];
}

/// Leaves out the vertices that no triangle uses: what looks at vertices is not to see them. Returns the new number of
/// each vertex, -1 for those left out.
std::vector<Index> drop_unused_vertices(SurfaceMesh& mesh) {
  std::vector<Index> number(mesh.positions.size(), -1);
  for (const Triangle& triangle : mesh.triangles)
    for (const Index v : triangle) number[static_cast<std::size_t>(v)] = 0;
  std::vector<Vec3> used;
  used.reserve(number.size() - static_cast<std::size_t>(std::count(number.begin(), number.end(), -1)));
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
  return number;
}

/// Used vertices with joined ones in one place, and open parts thickened; fills in `carried` too.
void take_surface(const SurfaceMesh& surface, const PreparationParams& params, const std::string& name, const Log& log,
                  PreparedSurface& prepared) {
  SurfaceMesh& taken = prepared.surface;
  taken.positions = surface.positions;
  taken.triangles = surface.triangles;
  taken.groups = surface.groups;
  for (std::size_t v = 0; v < surface.joined.size(); ++v)
    taken.positions[v] = surface.positions[static_cast<std::size_t>(surface.joined[v])];
  prepared.carried.reserve(taken.positions.size());
  for (const Vec3& position : taken.positions) prepared.carried.push_back({position, -1});
  const std::int64_t open = params.thickness > 0 ? thicken_sheets(taken, find_parts(taken), params.thickness) : 0;
  if (open > 0)
    log.info(fmt::format("body '{}': {} triangles of open parts became sheets {:.4g} m thick", name, open,
                         params.thickness));
  if (!params.keep_vertices) weld(taken);
  const std::vector<Index> number = drop_unused_vertices(taken);
  for (std::size_t v = 0; v < prepared.carried.size() && open == 0; ++v) prepared.carried[v].vertex = number[v];
}

/// A flat surface has no volume with any lattice, and a size by count would ask for a lattice without end.
void require_volume(const SurfaceParts& parts, const std::string& name) {
  constexpr double kFlat = 1e-9;  // of the area to the power of 3/2; a ball has 0.094
  double volume = 0, area = 0;
  bool open = false;
  for (const SurfacePart& part : parts.parts) {
    volume += std::abs(part.volume);
    area += part.area;
    open = open || part.open;
  }
  if (volume > kFlat * std::pow(area, 1.5)) return;
  throw input_error(
      fmt::format("body '{}': its surface is {}, so it encloses no volume. Accepted: a surface that encloses a volume, "
                  "or an open sheet with a thickness. {}.",
                  name, area > 0 ? "flat" : "no more than points and lines",
                  open && area > 0 ? "Set thickness" : "Check the mesh file"));
}

/// An open sheet has no inside; what its winding numbers would make of it is nobody's wish.
void require_inside(const PreparedSurface& prepared, const std::string& name) {
  const Index sheet = find_sheet(prepared.surface, prepared.parts);
  if (sheet < 0) return;
  const SurfacePart& part = prepared.parts.parts[static_cast<std::size_t>(sheet)];
  throw input_error(fmt::format(
      "body '{}': {} is an open sheet: it encloses nothing. Accepted: a "
      "surface that encloses a volume, or an open sheet with a thickness. Set thickness, close the surface, "
      "or take the part out of it.",
      name, part.place()));
}

}  // namespace

PreparedSurface prepare_surface(const SurfaceMesh& surface, const PreparationParams& params, const std::string& name,
                                const Log& log) {
  if (surface.triangles.empty())
    throw input_error(
        fmt::format("body '{}': its surface has no triangles, so there is nothing to fill. Accepted: a "
                    "surface that encloses a volume. Check the mesh file.",
                    name));
  PreparedSurface prepared;
  take_surface(surface, params, name, log, prepared);
  prepared.parts = find_parts(prepared.surface);
  prepared.box = used_bounds(prepared.surface);
  require_volume(prepared.parts, name);
  require_inside(prepared, name);
  return prepared;
}

}  // namespace softreel
