#include "core/mesh/point_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace softreel {

PointTree::PointTree(std::vector<Vec3> points) : points_(std::move(points)), order_(points_.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  build(0, order_.size(), 0);
}

void PointTree::build(std::size_t begin, std::size_t end, int axis) {
  if (end - begin < 2) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](Index a, Index b) {
    const double p = points_[static_cast<std::size_t>(a)][axis], q = points_[static_cast<std::size_t>(b)][axis];
    return p != q ? p < q : a < b;
  });
  build(begin, middle, (axis + 1) % 3);
  build(middle + 1, end, (axis + 1) % 3);
}

Index PointTree::nearest(const Vec3& q) const {
  Best best{std::numeric_limits<double>::infinity(), -1};
  search(0, order_.size(), 0, q, best);
  return best.index;
}

void PointTree::search(std::size_t begin, std::size_t end, int axis, const Vec3& q, Best& best) const {
  if (begin >= end) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const Index index = order_[middle];
  const Vec3& p = points_[static_cast<std::size_t>(index)];
  const double squared_distance = (p - q).squaredNorm();
  if (squared_distance < best.squared_distance || (squared_distance == best.squared_distance && index < best.index))
    best = {squared_distance, index};
  const double beyond = q[axis] - p[axis];
  const int next_axis = (axis + 1) % 3;
  if (beyond < 0)
    search(begin, middle, next_axis, q, best);
  else
    search(middle + 1, end, next_axis, q, best);
  if (beyond * beyond > best.squared_distance) return;
  if (beyond < 0)
    search(middle + 1, end, next_axis, q, best);
  else
    search(begin, middle, next_axis, q, best);
}

std::vector<Index> PointTree::nearest(const Vec3& q, std::size_t count) const {
  std::vector<Best> best;
  if (count > 0) search(0, order_.size(), 0, q, count, best);
  std::sort_heap(best.begin(), best.end());
  std::vector<Index> indices;
  for (const Best& one : best) indices.push_back(one.index);
  return indices;
}

void PointTree::search(std::size_t begin, std::size_t end, int axis, const Vec3& q, std::size_t count,
                       std::vector<Best>& best) const {
  if (begin >= end) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const Vec3& p = points_[static_cast<std::size_t>(order_[middle])];
  const Best own{(p - q).squaredNorm(), order_[middle]};
  if (best.size() == count && own < best.front()) {
    std::pop_heap(best.begin(), best.end());
    best.pop_back();
  }
  if (best.size() < count) {
    best.push_back(own);
    std::push_heap(best.begin(), best.end());
  }
  const double beyond = q[axis] - p[axis];
  const auto search_side = [&](bool lower) {
    search(lower ? begin : middle + 1, lower ? middle : end, (axis + 1) % 3, q, count, best);
  };
  search_side(beyond < 0);
  if (best.size() < count || beyond * beyond <= best.front().squared_distance) search_side(!(beyond < 0));
}

}  // namespace softreel
