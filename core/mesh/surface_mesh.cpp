#include "core/mesh/surface_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/base/number_table.h"

namespace softreel {

Bounds used_bounds(const SurfaceMesh& mesh) {
  Bounds bounds;
  for (const Triangle& triangle : mesh.triangles)
    for (const Index v : triangle) bounds.add(mesh.positions[static_cast<std::size_t>(v)]);
  return bounds;
}

std::vector<bool> used_vertices(const SurfaceMesh& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& triangle : mesh.triangles)
    for (const Index v : triangle) used[static_cast<std::size_t>(v)] = true;
  return used;
}

std::vector<Index> weld_positions(const std::vector<Vec3>& positions) {
  std::vector<Index> first(positions.size());
  NumberTable table(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3& p = positions[v];
    first[v] = static_cast<Index>(v);
    if (p != p) continue;  // not a number: like nothing else
    const Index known = table.find(position_hash(p), [&](Index u) { return positions[at(u)] == p; });
    if (known >= 0)
      first[v] = known;
    else
      table.insert(first[v], [&](Index u) { return position_hash(positions[at(u)]); });
  }
  return first;
}

namespace {

/// Angle between two edges; 0 if one has no length.
double corner_angle(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

std::vector<Vec3> vertex_normals(const SurfaceMesh& mesh, const std::vector<Vec3>& positions) {
  // As repair connected the triangles: a crease along rims that it joined would show.
  const std::vector<Index> weld = mesh.joined.empty() ? weld_positions(mesh.positions) : mesh.joined;
  std::vector<Vec3> normals(positions.size(), Vec3::Zero());
  for (const Triangle& triangle : mesh.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = positions[static_cast<std::size_t>(triangle[k])];
    const Vec3 area = (p[1] - p[0]).cross(p[2] - p[0]);
    const double length = area.norm();
    if (!(length > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = corner_angle(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
      normals[static_cast<std::size_t>(weld[static_cast<std::size_t>(triangle[k])])] += angle / length * area;
    }
  }
  for (std::size_t v = 0; v < normals.size(); ++v) {
    if (weld[v] != static_cast<Index>(v)) {
      normals[v] = normals[static_cast<std::size_t>(weld[v])];  // welded vertices come first and are normalised
      continue;
    }
    const double length = normals[v].norm();
    normals[v] = length > 0 ? Vec3(normals[v] / length) : Vec3::UnitY();
  }
  return normals;
}

}  // namespace softreel
