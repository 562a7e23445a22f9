#include "core/mesh/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace softreel {

Bounds used_bounds(const SurfaceMesh& mesh) {
  Bounds bounds;
  for (const Triangle& triangle : mesh.triangles)
    for (const Index v : triangle) bounds.add(mesh.positions[static_cast<std::size_t>(v)]);
  return bounds;
}

std::vector<Index> weld_positions(const std::vector<Vec3>& positions) {
  std::vector<Index> order(positions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&](Index v) -> const Vec3& { return positions[static_cast<std::size_t>(v)]; };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    const Vec3 &p = at(a), &q = at(b);
    for (int k = 0; k < 3; ++k) {
      if (p[k] < q[k]) return true;
      if (p[k] > q[k]) return false;
      if (std::isnan(p[k]) != std::isnan(q[k])) return std::isnan(q[k]);  // an order needs a place for NaN: last
    }
    return a < b;
  });
  std::vector<Index> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && at(order[i]) == at(order[i - 1]);
    first[static_cast<std::size_t>(order[i])] = same ? first[static_cast<std::size_t>(order[i - 1])] : order[i];
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
  const std::vector<Index> weld = weld_positions(mesh.positions);
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
