#include "core/tetmesh/winding_number.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/mesh_topology.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {
namespace {

/// A cluster is far beyond this multiple of its radius (beta of the paper, which recommends 2).
constexpr double kAccuracy = 2.0;

/// Half the solid angle of a triangle seen from the origin; positive if its front faces away from it.
double half_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

WindingNumber::WindingNumber(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
    : clusters_(points, triangles), dipoles_(clusters_.nodes().size()) {
  std::vector<double> weights(dipoles_.size());
  for (std::size_t n = dipoles_.size(); n-- > 0;) {  // children come after their parents
    const TriangleClusters::Node& node = clusters_.nodes()[n];
    Vec3 area = Vec3::Zero(), moment = Vec3::Zero();
    double weight = 0;
    const auto add = [&](const Vec3& part_area, const Vec3& center, double part_weight) {
      area += part_area;
      moment += part_weight * center;
      weight += part_weight;
    };
    if (node.is_leaf()) {
      for (Index i = node.begin; i < node.end; ++i) {
        const auto& [a, b, c] = clusters_.corners(i);
        const Vec3 normal = 0.5 * (b - a).cross(c - a);
        add(normal, (a + b + c) / 3.0, normal.norm());
      }
    } else {
      for (const std::size_t child : {n + 1, static_cast<std::size_t>(node.right)})
        add(dipoles_[child].area, dipoles_[child].center, weights[child]);
    }
    const Vec3 center = weight > 0 ? Vec3(moment / weight) : Vec3(0.5 * (node.min + node.max));
    const double radius = (center - node.min).cwiseMax(node.max - center).norm();
    dipoles_[n] = {center, area, kAccuracy * kAccuracy * radius * radius, node.begin, node.end, node.right};
    weights[n] = weight;
  }
  clusters_.drop_nodes();
}

double WindingNumber::operator()(const Vec3& p) const {
  if (dipoles_.empty()) return 0;
  std::array<Index, 64> stack;  // halving: depth at most 32
  std::size_t depth = 0;
  stack[depth++] = 0;
  double half_angles = 0, far = 0;
  while (depth > 0) {
    const auto n = static_cast<std::size_t>(stack[--depth]);
    const Dipole& dipole = dipoles_[n];
    const Vec3 r = dipole.center - p;
    const double squared = r.squaredNorm();
    if (squared > dipole.squared_reach) {
      far += dipole.area.dot(r) / (squared * std::sqrt(squared));
      continue;
    }
    if (dipole.right != 0) {
      stack[depth++] = dipole.right;
      stack[depth++] = static_cast<Index>(n) + 1;
      continue;
    }
    for (Index i = dipole.begin; i < dipole.end; ++i) {
      const auto& [a, b, c] = clusters_.corners(i);
      half_angles += half_solid_angle(a - p, b - p, c - p);
    }
  }
  return (2.0 * half_angles + far) / (4.0 * std::numbers::pi);
}

bool has_integer_windings(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  const std::vector<Triangle> welded = welded_triangles(triangles, weld_positions(positions));
  bool all_balanced = true;
  for_each_edge(sorted_half_edges(welded),
                [&](std::span<const HalfEdge> edge) { all_balanced = all_balanced && is_balanced(edge); });
  return all_balanced;
}

}  // namespace softreel
