#include "core/tetmesh/surface/row_crossings.h"

#include <algorithm>
#include <cmath>

namespace softreel {
namespace {

std::uint64_t row_key(std::int32_t y, std::int32_t z) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 | static_cast<std::uint32_t>(z);
}

/// The smallest integer not below `value` that is as odd as `like`.
std::int32_t first_of_parity(double value, std::int32_t like) {
  const auto first = static_cast<std::int32_t>(std::ceil(value));
  return first + ((first ^ like) & 1);
}

/// Where an edge meets the plane of a given y; the same for both directions of the edge.
struct EdgePoint {
  double x, z;
};
EdgePoint edge_point(std::array<double, 3> a, std::array<double, 3> b, double y) {
  if (b < a) std::swap(a, b);
  const double t = (y - a[1]) / (b[1] - a[1]);
  return {a[0] + t * (b[0] - a[0]), a[2] + t * (b[2] - a[2])};
}

using RowCorners = std::array<std::array<double, 3>, 3>;

RowCorners in_lattice_units(const std::array<Vec3, 3>& triangle, const LatticeFrame& frame) {
  RowCorners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 p = (triangle[k] - frame.origin) * (2.0 / frame.spacing);
    corners[k] = {p[0], p[1], p[2]};
  }
  return corners;
}

/// A triangle cut by the plane of a y that it reaches from below. Of the three edges one goes up through the plane
/// (from y or below to above it) and one down.
struct PlaneCut {
  EdgePoint up{}, down{};

  PlaneCut(const RowCorners& corners, std::int32_t y) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto &a = corners[k], &b = corners[(k + 1) % 3];
      if (a[1] <= y && b[1] > y) up = edge_point(a, b, y);
      if (a[1] > y && b[1] <= y) down = edge_point(a, b, y);
    }
  }

  int sign() const { return up.z < down.z ? 1 : -1; }  // counter-clockwise seen from +x: the front looks that way
  double z_begin() const { return std::min(up.z, down.z); }
  double z_end() const { return std::max(up.z, down.z); }
  double x_at(double z) const {
    const double t = (z - down.z) / (up.z - down.z);
    return down.x + t * (up.x - down.x);
  }
};

}  // namespace

RowCrossings::RowCrossings(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                           const LatticeFrame& frame, const RowRange& rows) {
  for (const Triangle& triangle : triangles) {
    std::array<Vec3, 3> x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = positions[static_cast<std::size_t>(triangle[k])];
    cross_triangle(in_lattice_units(x, frame), rows);
  }
  std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
    if (a.z != b.z) return a.z < b.z;
    if (a.y != b.y) return a.y < b.y;
    return a.x != b.x ? a.x < b.x : a.sign < b.sign;
  });
  for (std::size_t c = 0; c < crossings_.size(); ++c) {
    if (c > 0 && crossings_[c].y == crossings_[c - 1].y && crossings_[c].z == crossings_[c - 1].z) continue;
    row_begins_.push_back(static_cast<Index>(c));
    table_.insert(static_cast<Index>(row_begins_.size() - 1), [&](Index row) {
      const Crossing& first = first_of_row(row);
      return row_key(first.y, first.z);
    });
  }
  row_begins_.push_back(static_cast<Index>(crossings_.size()));
}

void RowCrossings::cross_triangle(const std::array<Corner, 3>& corners, const RowRange& rows) {
  const auto [first, last] = std::minmax({corners[0][2], corners[1][2], corners[2][2]});
  if (last + 1 < rows.begin || first - 1 >= rows.end) return;  // 1: more than round-off
  const auto [low, high] = std::minmax({corners[0][1], corners[1][1], corners[2][1]});
  for (auto y = static_cast<std::int32_t>(std::ceil(low)); y < high; ++y) {
    const PlaneCut cut(corners, y);
    const double end = std::min<double>(cut.z_end(), rows.end);
    for (std::int32_t z = first_of_parity(std::max<double>(cut.z_begin(), rows.begin), y); z < end; z += 2)
      crossings_.push_back({z, y, cut.x_at(z), cut.sign()});
  }
}

int RowCrossings::winding(const LatticeNode& node) const {
  const Index row = table_.find(row_key(node[1], node[2]), [&](Index number) {
    const Crossing& first = first_of_row(number);
    return first.y == node[1] && first.z == node[2];
  });
  if (row < 0) return 0;
  int winding = 0;
  for (Index c = row_begins_[static_cast<std::size_t>(row)]; c < row_begins_[static_cast<std::size_t>(row) + 1]; ++c)
    if (crossings_[static_cast<std::size_t>(c)].x <= node[0]) winding -= crossings_[static_cast<std::size_t>(c)].sign;
  return winding;
}

int winding_of_node(const TriangleTree& tree, const LatticeFrame& frame, const LatticeNode& node) {
  constexpr double kMargin = 1e-6;  // lattice units; far above the round-off of a box
  const double scale = 2.0 / frame.spacing;
  const auto meets = [&](const Vec3& min, const Vec3& max) {
    const Vec3 low = (min - frame.origin) * scale, high = (max - frame.origin) * scale;
    return low[0] <= node[0] + kMargin && low[1] <= node[1] + kMargin && high[1] >= node[1] - kMargin &&
           low[2] <= node[2] + kMargin && high[2] >= node[2] - kMargin;
  };
  int winding = 0;
  tree.visit(meets, [&](Index place) {
    const RowCorners corners = in_lattice_units(tree.corners(place), frame);
    const auto [from, to] = std::minmax({corners[0][1], corners[1][1], corners[2][1]});
    if (!(from <= node[1] && node[1] < to)) return;
    const PlaneCut cut(corners, node[1]);
    if (cut.z_begin() <= node[2] && node[2] < cut.z_end() && cut.x_at(node[2]) <= node[0]) winding -= cut.sign();
  });
  return winding;
}

}  // namespace softreel
