#include "core/tetmesh/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace softreel {
namespace {

constexpr Index kLeafSize = 4;

/// Of a tree over so many triangles.
std::size_t count_nodes(Index triangles) {
  return triangles <= kLeafSize ? 1 : 1 + count_nodes(triangles / 2) + count_nodes(triangles - triangles / 2);
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

TriangleTree::TriangleTree(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
    : order_(triangles.size()) {
  if (triangles.empty()) return;
  std::iota(order_.begin(), order_.end(), 0);
  Given given{points, triangles, {}};
  given.centroids.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    given.centroids.push_back((points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)] +
                               points[static_cast<std::size_t>(c)]) /
                              3.0);
  nodes_.reserve(count_nodes(static_cast<Index>(triangles.size())));
  build(given, 0, static_cast<Index>(triangles.size()));
  std::vector<Vec3>().swap(given.centroids);
  take_corners(given);
}

void TriangleTree::take_corners(const Given& given) {
  std::vector<Index> numbers(given.points.size(), -1);
  triangles_.reserve(order_.size());
  for (const Index t : order_) {
    Triangle triangle = given.triangles[static_cast<std::size_t>(t)];
    for (Index& v : triangle) {
      Index& number = numbers[static_cast<std::size_t>(v)];
      if (number < 0) {
        number = static_cast<Index>(points_.size());
        points_.push_back(given.points[static_cast<std::size_t>(v)]);
      }
      v = number;
    }
    triangles_.push_back(triangle);
  }
  points_.shrink_to_fit();
}

TriangleTree::Nearest TriangleTree::nearest_from(const Vec3& p, Index place, double squared_enough,
                                                 double squared_limit) const {
  Nearest guess;
  if (place >= 0) {
    const auto& [a, b, c] = corners(place);
    guess.point = nearest_on_triangle(p, a, b, c);
    guess.triangle = order_[static_cast<std::size_t>(place)];
    guess.squared_distance = (guess.point - p).squaredNorm();
    guess.place = place;
  }
  if (guess.squared_distance > squared_limit) {
    guess = {};
    guess.squared_distance = squared_limit;
  }
  return search(p, guess, squared_enough, [](Index, const Vec3&) { return true; });
}

void TriangleTree::build(const Given& given, Index begin, Index end) {
  const auto number = static_cast<Index>(nodes_.size());
  Node node{Vec3::Constant(1e300), Vec3::Constant(-1e300), begin, end, 0};
  Vec3 low = node.min, high = node.max;
  for (Index i = begin; i < end; ++i) {
    const auto t = static_cast<std::size_t>(order_[static_cast<std::size_t>(i)]);
    for (const Index v : given.triangles[t]) {
      const Vec3& corner = given.points[static_cast<std::size_t>(v)];
      node.min = node.min.cwiseMin(corner);
      node.max = node.max.cwiseMax(corner);
    }
    low = low.cwiseMin(given.centroids[t]);
    high = high.cwiseMax(given.centroids[t]);
  }
  nodes_.push_back(node);
  if (end - begin <= kLeafSize) return;
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const Index middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](Index a, Index b) {
    const double x = given.centroids[static_cast<std::size_t>(a)][axis],
                 y = given.centroids[static_cast<std::size_t>(b)][axis];
    return x != y ? x < y : a < b;
  });
  build(given, begin, middle);
  nodes_[static_cast<std::size_t>(number)].right = static_cast<Index>(nodes_.size());
  build(given, middle, end);
}

}  // namespace softreel
