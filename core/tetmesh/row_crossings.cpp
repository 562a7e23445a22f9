#include "core/tetmesh/row_crossings.h"

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

}  // namespace

RowCrossings::RowCrossings(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                           const LatticeFrame& frame) {
  for (const Triangle& triangle : triangles) {
    std::array<Corner, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = (positions[static_cast<std::size_t>(triangle[k])] - frame.origin) * (2.0 / frame.spacing);
      corners[k] = {p[0], p[1], p[2]};
    }
    cross_triangle(corners);
  }
  std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
    if (a.z != b.z) return a.z < b.z;
    if (a.y != b.y) return a.y < b.y;
    return a.x != b.x ? a.x < b.x : a.sign < b.sign;
  });
  for (std::size_t c = 0; c < crossings_.size(); ++c)
    if (rows_.insert(row_key(crossings_[c].y, crossings_[c].z)).second) row_begins_.push_back(static_cast<Index>(c));
  row_begins_.push_back(static_cast<Index>(crossings_.size()));
}

void RowCrossings::cross_triangle(const std::array<Corner, 3>& corners) {
  const auto [low, high] = std::minmax({corners[0][1], corners[1][1], corners[2][1]});
  for (auto y = static_cast<std::int32_t>(std::ceil(low)); y < high; ++y) {
    // Of the three edges one goes up through the plane (from y or below to above it) and one down.
    EdgePoint up{}, down{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner &a = corners[k], &b = corners[(k + 1) % 3];
      if (a[1] <= y && b[1] > y) up = edge_point(a, b, y);
      if (a[1] > y && b[1] <= y) down = edge_point(a, b, y);
    }
    const int sign = up.z < down.z ? 1 : -1;  // counter-clockwise seen from +x: the front looks that way
    const double z_end = std::max(up.z, down.z);
    for (std::int32_t z = first_of_parity(std::min(up.z, down.z), y); z < z_end; z += 2) {
      const double t = (z - down.z) / (up.z - down.z);
      crossings_.push_back({z, y, down.x + t * (up.x - down.x), sign});
    }
  }
}

int RowCrossings::winding(const LatticeNode& node) const {
  const Index row = rows_.find(row_key(node[1], node[2]));
  if (row < 0) return 0;
  int winding = 0;
  for (Index c = row_begins_[static_cast<std::size_t>(row)]; c < row_begins_[static_cast<std::size_t>(row) + 1]; ++c)
    if (crossings_[static_cast<std::size_t>(c)].x <= node[0]) winding -= crossings_[static_cast<std::size_t>(c)].sign;
  return winding;
}

bool RowCrossings::overlaps() const {
  for (std::size_t r = 0; r + 1 < row_begins_.size(); ++r) {
    int winding = 0;
    for (Index c = row_begins_[r]; c < row_begins_[r + 1]; ++c) {
      winding -= crossings_[static_cast<std::size_t>(c)].sign;
      if (std::abs(winding) > 1) return true;
    }
  }
  return false;
}

}  // namespace softreel
