#include "core/tetmesh/surface/hole_caps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/tetmesh/farthest_point.h"
#include "core/tetmesh/surface/surface_pieces.h"

namespace softreel {
namespace {

/// So far is looked, in distances to the surface. Less than 1, so that the way does not cross it.
constexpr double kLook = 0.95;

/// Pieces at the border of a cap are this share of the limit long.
constexpr double kPiece = 0.5;

/// To the sides and the corners of a cube.
const std::array<Vec3, 14>& directions() {
  static const std::array<Vec3, 14> all = [] {
    std::array<Vec3, 14> list;
    std::size_t n = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) list[n++] = sign * Vec3::Unit(axis);
    for (unsigned corner = 0; corner < 8; ++corner)
      list[n++] = Vec3(corner & 1U ? 1 : -1, corner & 2U ? 1 : -1, corner & 4U ? 1 : -1).normalized();
    return list;
  }();
  return all;
}

}  // namespace

HoleCaps::HoleCaps(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, const TriangleTree& tree)
    : tree_(tree) {
  if (!has_integer_windings(points, triangles)) winding_.emplace(points, triangles);
}

bool HoleCaps::contain(const Vec3& p) const {
  if (!winding_) return false;
  const auto is_inside = [&](const Vec3& x) { return std::abs(winding_->quick(x)) > 0.5; };
  const double reach = kLook * std::sqrt(tree_.nearest(p).squared_distance);
  const bool inside = is_inside(p);
  return reach > 0 && std::ranges::any_of(directions(), [&](const Vec3& direction) {
           return is_inside(p + reach * direction) != inside;
         });
}

SurfaceMesh HoleCaps::without_caps(const std::vector<Vec3>& points, const std::vector<Triangle>& faces, double limit,
                                   const Threads& threads) const {
  const std::vector<std::uint8_t> suspected = find_far_triangles(points, faces, tree_, limit, threads);
  PieceRules rules;
  rules.leaves_out = [this](const TriangleCorners&, const Vec3& p) { return contain(p); };
  rules.border = kPiece * limit;
  return without_pieces(points, faces, suspected, rules, threads);
}

}  // namespace softreel
