#include "core/mesh/ordered_triangles.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace softreel {

TriangleSorter::TriangleSorter(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
    : order_(triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  centroids_.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) centroids_.push_back((points[at(a)] + points[at(b)] + points[at(c)]) / 3.0);
}

void TriangleSorter::split(Index begin, Index middle, Index end) {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (Index i = begin; i < end; ++i) {
    const Vec3& centroid = centroids_[at(order_[at(i)])];
    low = low.cwiseMin(centroid);
    high = high.cwiseMax(centroid);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](Index a, Index b) {
    const double x = centroids_[at(a)][axis], y = centroids_[at(b)][axis];
    return x != y ? x < y : a < b;
  });
}

OrderedTriangles::OrderedTriangles(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                   std::vector<Index> order)
    : order_(std::move(order)) {
  std::vector<Index> numbers(points.size(), -1);
  triangles_.reserve(order_.size());
  for (const Index t : order_) {
    Triangle triangle = triangles[at(t)];
    for (Index& v : triangle) {
      Index& number = numbers[at(v)];
      if (number < 0) {
        number = static_cast<Index>(points_.size());
        points_.push_back(points[at(v)]);
      }
      v = number;
    }
    triangles_.push_back(triangle);
  }
  points_.shrink_to_fit();
}

}  // namespace softreel
