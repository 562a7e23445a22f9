#include "core/tetmesh/graded/graded_octree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

LatticeNode shifted(LatticeNode node, std::size_t axis, std::int32_t by) {
  node[axis] += by;
  return node;
}

/// Six times the volume in units.
std::int64_t orientation(const std::array<LatticeNode, 4>& x) {
  std::array<std::array<std::int64_t, 3>, 3> d;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) d[i][k] = std::int64_t{x[i + 1][k]} - x[0][k];
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

using VisitTet = std::function<void(const std::array<LatticeNode, 4>&)>;

void visit_oriented(std::array<LatticeNode, 4> tet, const VisitTet& visit) {
  if (orientation(tet) < 0) std::swap(tet[2], tet[3]);
  visit(tet);
}

/// The corners of a cell's face, in a circle. side: 0 towards lower coordinates, 1 towards higher ones.
std::array<LatticeNode, 4> face_corners(const OctreeCell& cell, std::size_t axis, std::int32_t side) {
  const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  const LatticeNode first = shifted(cell.low, axis, side * cell.width());
  return {first, shifted(first, a, cell.width()), shifted(shifted(first, a, cell.width()), b, cell.width()),
          shifted(first, b, cell.width())};
}

/// Between two leaves of one size: four tetrahedra round the line of their centres, in halves where the edge of the
/// face has a node in its middle.
void visit_equal_leaves(const OctreeCell& cell, const OctreeCell& other, std::size_t axis, const LatticeNodeSet& set,
                        const VisitTet& visit) {
  const std::array<LatticeNode, 4> corners = face_corners(cell, axis, 1);
  for (std::size_t k = 0; k < 4; ++k) {
    const LatticeNode &p = corners[k], &q = corners[(k + 1) % 4];
    const LatticeNode middle{(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2};
    if (cell.level > 0 && set.find(middle) >= 0) {
      visit_oriented({cell.center(), other.center(), p, middle}, visit);
      visit_oriented({cell.center(), other.center(), middle, q}, visit);
    } else {
      visit_oriented({cell.center(), other.center(), p, q}, visit);
    }
  }
}

/// Between a leaf and one of twice its size: the face is cut along the diagonal to the larger face's middle.
void visit_unequal_leaves(const OctreeCell& cell, const OctreeCell& larger, std::size_t axis, std::int32_t side,
                          const VisitTet& visit) {
  const std::array<LatticeNode, 4> corners = face_corners(cell, axis, side);
  const LatticeNode middle = larger.center();
  for (std::size_t k = 0; k < 4; ++k) {
    const bool is_middle =
        corners[k][(axis + 1) % 3] == middle[(axis + 1) % 3] && corners[k][(axis + 2) % 3] == middle[(axis + 2) % 3];
    if (!is_middle) continue;
    const LatticeNode &g = corners[k], &p = corners[(k + 2) % 4];
    for (const LatticeNode& edge : {corners[(k + 1) % 4], corners[(k + 3) % 4]}) {
      visit_oriented({cell.center(), g, edge, p}, visit);
      visit_oriented({larger.center(), g, edge, p}, visit);
    }
  }
}

}  // namespace

GradedOctree::GradedOctree(const LatticeFrame& frame, const Bounds& box, std::int32_t top) : frame_(frame), top_(top) {
  const std::int32_t width = std::int32_t{2} << top;
  const Vec3 min = in_units(box.min) / width, max = in_units(box.max) / width;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<int>(k);
    const double first = std::floor(min[axis]) - 1, end = std::floor(max[axis]) + 2;
    CHECK(width * std::max(-first, end) <= kMaxLatticeCoordinate);
    low_[k] = static_cast<std::int32_t>(first) * width;
    counts_[k] = static_cast<std::int32_t>(end - first);
  }
  for (std::int32_t z = 0; z < counts_[2]; ++z)
    for (std::int32_t y = 0; y < counts_[1]; ++y)
      for (std::int32_t x = 0; x < counts_[0]; ++x)
        cells_.push_back({{low_[0] + x * width, low_[1] + y * width, low_[2] + z * width}, top});
}

double GradedOctree::finest_edge() const {
  std::int32_t least = top_;
  for (const OctreeCell& cell : cells_) least = std::min(least, cell.level);
  return std::ldexp(frame_.spacing, least);
}

Index GradedOctree::find_leaf(const LatticeNode& unit) const {
  std::array<std::int32_t, 3> root;
  for (std::size_t k = 0; k < 3; ++k) {
    root[k] = (unit[k] - low_[k]) >> (top_ + 1);
    if (unit[k] < low_[k] || root[k] >= counts_[k]) return -1;
  }
  Index cell = (root[2] * counts_[1] + root[1]) * counts_[0] + root[0];
  while (cells_[at(cell)].first_child >= 0) {
    const LatticeNode center = cells_[at(cell)].center();
    Index child = 0;
    for (std::size_t k = 0; k < 3; ++k) child += unit[k] >= center[k] ? Index{1} << k : 0;
    cell = cells_[at(cell)].first_child + child;
  }
  return cell;
}

void GradedOctree::split(Index cell) {
  const OctreeCell old = cells_[at(cell)];
  // What touches at a face or an edge must not be larger than the cell that is split.
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dz = -1; dz <= 1; ++dz) {
        if (std::abs(dx) + std::abs(dy) + std::abs(dz) > 2) continue;
        const LatticeNode beside{old.low[0] + dx * old.width(), old.low[1] + dy * old.width(),
                                 old.low[2] + dz * old.width()};
        for (Index leaf = find_leaf(beside); leaf >= 0 && cells_[at(leaf)].level > old.level; leaf = find_leaf(beside))
          split(leaf);
      }
  cells_[at(cell)].first_child = static_cast<Index>(cells_.size());
  const std::int32_t half = old.width() / 2;
  for (std::int32_t k = 0; k < 8; ++k)
    cells_.push_back({{old.low[0] + (k & 1) * half, old.low[1] + ((k >> 1) & 1) * half, old.low[2] + (k >> 2) * half},
                      old.level - 1});
}

template <typename Overlaps>
void GradedOctree::refine_where(const Overlaps& overlaps, const Bounds& box, std::int32_t level) {
  std::vector<Index> open;
  const std::int32_t width = std::int32_t{2} << top_;
  std::array<std::int32_t, 3> begin, end;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<int>(k);
    begin[k] = std::max(0, static_cast<std::int32_t>(std::floor((box.min[axis] - low_[k]) / width - 0.5)));
    end[k] = std::min(counts_[k] - 1, static_cast<std::int32_t>(std::floor((box.max[axis] - low_[k]) / width + 0.5)));
  }
  for (std::int32_t z = begin[2]; z <= end[2]; ++z)
    for (std::int32_t y = begin[1]; y <= end[1]; ++y)
      for (std::int32_t x = begin[0]; x <= end[0]; ++x) open.push_back((z * counts_[1] + y) * counts_[0] + x);
  while (!open.empty()) {
    const Index cell = open.back();
    open.pop_back();
    if (cells_[at(cell)].level <= level || !overlaps(cells_[at(cell)])) continue;
    if (cells_[at(cell)].first_child < 0) split(cell);
    for (Index k = 0; k < 8; ++k) open.push_back(cells_[at(cell)].first_child + k);
  }
}

void GradedOctree::refine(const std::array<Vec3, 3>& triangle, std::int32_t level) {
  // A sphere round the cell and a little more: no larger leaf comes as near to the surface as a quarter of its width.
  constexpr double kReach = 0.87 + 0.25;
  std::array<Vec3, 3> x;
  Bounds box;
  for (std::size_t k = 0; k < 3; ++k) {
    x[k] = in_units(triangle[k]);
    box.add(x[k]);
  }
  refine_where(
      [&](const OctreeCell& cell) {
        const LatticeNode c = cell.center();
        const Vec3 center(c[0], c[1], c[2]);
        return (nearest_on_triangle(center, x[0], x[1], x[2]) - center).norm() <= kReach * cell.width();
      },
      box, level);
}

void GradedOctree::refine(const Vec3& point, std::int32_t level, double margin) {
  const Vec3 p = in_units(point);
  Bounds box;
  box.add(p);
  refine_where(
      [&](const OctreeCell& cell) {
        const LatticeNode c = cell.center();
        return (p - Vec3(c[0], c[1], c[2])).cwiseAbs().maxCoeff() <= (0.5 + margin) * cell.width();
      },
      box, level);
}

std::int32_t GradedOctree::level_at(const Vec3& point) const {
  const Vec3 p = in_units(point);
  LatticeNode unit;
  for (std::size_t k = 0; k < 3; ++k) unit[k] = static_cast<std::int32_t>(std::floor(p[static_cast<int>(k)]));
  const Index leaf = find_leaf(unit);
  return leaf < 0 ? top_ : cells_[at(leaf)].level;
}

LatticeNodeSet GradedOctree::nodes() const {
  LatticeNodeSet set;
  for (const OctreeCell& cell : cells_) {
    if (cell.first_child >= 0) continue;
    set.insert(cell.center());
    for (std::int32_t side = 0; side < 2; ++side)
      for (const LatticeNode& corner : face_corners(cell, 0, side)) set.insert(corner);
  }
  set.number_nodes();
  return set;
}

std::vector<double> GradedOctree::widths(const LatticeNodeSet& set) const {
  std::vector<double> widths(set.nodes().size(), 0.0);
  for (const OctreeCell& cell : cells_) {
    if (cell.first_child >= 0) continue;
    const auto widen = [&](const LatticeNode& node) {
      double& width = widths[at(set.find(node))];
      width = std::max(width, 0.5 * frame_.spacing * cell.width());
    };
    widen(cell.center());
    for (std::int32_t side = 0; side < 2; ++side)
      for (const LatticeNode& corner : face_corners(cell, 0, side)) widen(corner);
  }
  return widths;
}

void GradedOctree::visit_tets(const LatticeNodeSet& set, const VisitTet& visit) const {
  for (const OctreeCell& cell : cells_) {
    if (cell.first_child >= 0) continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::int32_t side = 0; side < 2; ++side) {
        const Index leaf = find_leaf(shifted(cell.low, axis, side == 0 ? -1 : cell.width()));
        if (leaf < 0) continue;
        const OctreeCell& other = cells_[at(leaf)];
        if (other.level > cell.level) visit_unequal_leaves(cell, other, axis, side, visit);
        if (other.level == cell.level && side == 1) visit_equal_leaves(cell, other, axis, set, visit);
      }
  }
}

}  // namespace softreel
