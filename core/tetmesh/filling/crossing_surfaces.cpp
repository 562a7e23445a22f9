#include "core/tetmesh/filling/crossing_surfaces.h"

#include <array>
#include <vector>

namespace softreel {
namespace {

using Corners = std::array<Vec3, 3>;

double orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Whether the segment p-q passes through the inside of a triangle; touching does not count.
bool crosses(const Vec3& p, const Vec3& q, const Corners& t) {
  const double above = orientation(t[0], t[1], t[2], p), below = orientation(t[0], t[1], t[2], q);
  if (!(above * below < 0)) return false;
  const double a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]), c = orientation(p, q, t[2], t[0]);
  return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

Vec3 min_of(const Corners& x) {
  return x[0].cwiseMin(x[1]).cwiseMin(x[2]);
}
Vec3 max_of(const Corners& x) {
  return x[0].cwiseMax(x[1]).cwiseMax(x[2]);
}

bool overlap(const Vec3& min, const Vec3& max, const Vec3& other_min, const Vec3& other_max) {
  return ((min.array() <= other_max.array()) && (other_min.array() <= max.array())).all();
}

/// Whether all of a triangle lies on one side of another's plane.
bool is_beside(const Corners& s, const Corners& t) {
  const double a = orientation(t[0], t[1], t[2], s[0]), b = orientation(t[0], t[1], t[2], s[1]),
               c = orientation(t[0], t[1], t[2], s[2]);
  return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

bool cross_each_other(const Corners& s, const Corners& t) {
  // These are told much faster than a cross, and of nested shells all triangles but a few are apart.
  if (!overlap(min_of(s), max_of(s), min_of(t), max_of(t)) || is_beside(s, t) || is_beside(t, s)) return false;
  for (std::size_t k = 0; k < 3; ++k)
    if (crosses(s[k], s[(k + 1) % 3], t) || crosses(t[k], t[(k + 1) % 3], s)) return true;
  return false;
}

}  // namespace

bool any_cross(const TriangleClusters& first, const TriangleClusters& second, const Vec3& shift) {
  std::vector<std::array<Index, 2>> open{{0, 0}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    const TriangleClusters::Node &a = first.nodes()[at(i)], &b = second.nodes()[at(j)];
    if (!overlap(a.min, a.max, b.min + shift, b.max + shift)) continue;
    if (a.is_leaf() && b.is_leaf()) {
      for (Index t = b.begin; t < b.end; ++t) {
        Corners moved = second.corners(t);
        for (Vec3& corner : moved) corner += shift;
        if (!overlap(a.min, a.max, min_of(moved), max_of(moved))) continue;
        for (Index s = a.begin; s < a.end; ++s)
          if (cross_each_other(first.corners(s), moved)) return true;
      }
    } else if (b.is_leaf() || (!a.is_leaf() && a.end - a.begin >= b.end - b.begin)) {
      open.push_back({i + 1, j});
      open.push_back({a.right, j});
    } else {
      open.push_back({i, j + 1});
      open.push_back({i, b.right});
    }
  }
  return false;
}

}  // namespace softreel
