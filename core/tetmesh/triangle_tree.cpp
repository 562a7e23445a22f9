#include "core/tetmesh/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softreel {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Points and boxes are drawn into a cube of this half size, m: their squares are finite then, and what is drawn into
/// a convex body comes no further apart.
constexpr double kFar = 1e18;

float rounded_down(double x) {
  x = std::clamp(x, -kFar, kFar);
  const auto rounded = static_cast<float>(x);
  return rounded > x ? std::nextafter(rounded, -kInfinity) : rounded;
}

float rounded_up(double x) {
  return -rounded_down(-x);
}

}  // namespace

Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 - d6 > 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0)
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  if (!(sum > 0)) return a;  // a triangle without area whose edges were all declined by round-off
  return a + vb / sum * ab + vc / sum * ac;
}

TriangleTree::TriangleTree(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  if (triangles.empty()) return;
  TriangleSorter sorter(points, triangles);
  order_node(sorter, 0, static_cast<Index>(triangles.size()));
  triangles_ = OrderedTriangles(points, triangles, sorter.take_order());
  find_boxes();
}

/// Orders the triangles of one node: all its children but the last are full.
void TriangleTree::order_node(TriangleSorter& sorter, Index begin, Index end) {
  if (end - begin <= kWidth) return;
  std::int64_t child_size = kWidth;
  while (child_size * kWidth < end - begin) child_size *= kWidth;
  order_children(sorter, begin, end, static_cast<Index>(child_size));
}

void TriangleTree::order_children(TriangleSorter& sorter, Index begin, Index end, Index child_size) {
  if (end - begin <= child_size) return order_node(sorter, begin, end);
  const Index children = (end - begin - 1) / child_size + 1, middle = begin + (children + 1) / 2 * child_size;
  sorter.split(begin, middle, end);
  order_children(sorter, begin, middle, child_size);
  order_children(sorter, middle, end, child_size);
}

void TriangleTree::find_boxes() {
  const auto count = static_cast<Index>(order().size());
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (Index place = 0; place < count; ++place)
    for (const Vec3& corner : corners(place)) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  middle_ = 0.5 * (low + high);
  std::vector<Index> level_counts;
  for (Index n = count; level_counts.empty() || n > 1; level_counts.push_back(n)) n = (n - 1) / kWidth + 1;
  std::size_t nodes = 0;
  for (const Index n : level_counts) {
    level_begins_.push_back(nodes);
    nodes += at(n);
  }
  Node empty;
  for (std::size_t k = 0; k < 3; ++k) {
    empty.min[k].setConstant(kInfinity);
    empty.max[k].setConstant(-kInfinity);
  }
  nodes_.assign(nodes, empty);
  for (Index place = 0; place < count; ++place) {
    const auto& [a, b, c] = corners(place);
    Node& node = nodes_[at(place / kWidth)];
    const Vec3 min = a.cwiseMin(b).cwiseMin(c) - middle_, max = a.cwiseMax(b).cwiseMax(c) - middle_;
    for (int k = 0; k < 3; ++k) {
      node.min[static_cast<std::size_t>(k)][place % kWidth] = rounded_down(min[k]);
      node.max[static_cast<std::size_t>(k)][place % kWidth] = rounded_up(max[k]);
    }
  }
  for (std::size_t level = 1; level < level_begins_.size(); ++level)
    for (Index number = 0; number < level_counts[level - 1]; ++number) {
      const Node& child = nodes_[level_begins_[level - 1] + at(number)];
      Node& node = nodes_[level_begins_[level] + at(number / kWidth)];
      for (std::size_t k = 0; k < 3; ++k) {
        node.min[k][number % kWidth] = child.min[k].minCoeff();
        node.max[k][number % kWidth] = child.max[k].maxCoeff();
      }
    }
}

TriangleTree::Query TriangleTree::query_of(const Vec3& p) const {
  Query query;
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = p[static_cast<Eigen::Index>(k)] - middle_[static_cast<Eigen::Index>(k)];
    const auto rounded = static_cast<float>(std::clamp(x, -kFar, kFar));
    const float margin = std::abs(rounded) * FLT_EPSILON + FLT_MIN;  // no less than a last bit
    query.low[k] = rounded - margin;
    query.high[k] = rounded + margin;
  }
  return query;
}

TriangleTree::Nearest TriangleTree::nearest_from(const Vec3& p, Index place, double squared_enough,
                                                 double squared_limit) const {
  Nearest guess;
  if (place >= 0) {
    const auto& [a, b, c] = corners(place);
    guess.point = nearest_on_triangle(p, a, b, c);
    guess.triangle = order()[at(place)];
    guess.squared_distance = (guess.point - p).squaredNorm();
    guess.place = place;
  }
  if (guess.squared_distance > squared_limit) {
    guess = {};
    guess.squared_distance = squared_limit;
  }
  return search(p, guess, squared_enough, [](Index, const Vec3&) { return true; });
}

}  // namespace softreel
