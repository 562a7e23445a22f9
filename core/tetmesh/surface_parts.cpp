#include "core/tetmesh/surface_parts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/tetmesh/disjoint_sets.h"

namespace softreel {
namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// Name of the first group that holds a vertex, "" if none does.
std::string group_of(const SurfaceMesh& surface, Index vertex) {
  for (const VertexGroup& group : surface.groups)
    if (std::binary_search(group.vertices.begin(), group.vertices.end(), vertex)) return group.name;
  return {};
}

void measure_parts(const SurfaceMesh& surface, SurfaceParts& found) {
  const Vec3 center = used_bounds(surface).center();
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    SurfacePart& part = found.parts[at(found.triangle_parts[t])];
    std::array<Vec3, 3> x;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = surface.positions[at(surface.triangles[t][k])] - center;
      part.box.add(surface.positions[at(surface.triangles[t][k])]);
    }
    ++part.triangles;
    part.volume += x[0].cross(x[1]).dot(x[2]) / 6.0;
    part.area += 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
  }
}

}  // namespace

double SurfaceParts::area() const {
  double sum = 0;
  for (const SurfacePart& part : parts) sum += part.area;
  return sum;
}

double SurfaceParts::volume() const {
  double sum = 0;
  for (const SurfacePart& part : parts) sum += part.volume;
  return std::abs(sum);
}

SurfaceParts find_parts(const SurfaceMesh& surface) {
  const std::vector<Index> weld = weld_positions(surface.positions);
  DisjointSets sets(surface.positions.size());
  for (const Triangle& triangle : surface.triangles)
    for (std::size_t k = 1; k < 3; ++k) sets.join(weld[at(triangle[0])], weld[at(triangle[k])]);
  SurfaceParts found;
  std::vector<Index> number(surface.positions.size(), -1), first_vertices;
  for (const Triangle& triangle : surface.triangles) {
    Index& part = number[at(sets.root(weld[at(triangle[0])]))];
    if (part < 0) {
      part = static_cast<Index>(first_vertices.size());
      first_vertices.push_back(triangle[0]);
    }
    found.triangle_parts.push_back(part);
  }
  found.parts.resize(first_vertices.size());
  measure_parts(surface, found);
  for (std::size_t p = 0; p < found.parts.size(); ++p) {
    const std::string group = group_of(surface, first_vertices[p]);
    found.parts[p].name = fmt::format("part {} of {} ({}{} triangles)", p + 1, found.parts.size(),
                                      group.empty() ? "" : "group '" + group + "', ", found.parts[p].triangles);
  }
  return found;
}

}  // namespace softreel
