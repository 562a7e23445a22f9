#include "core/tetmesh/farthest_point.h"

#include <algorithm>
#include <cmath>

namespace softreel {
namespace {

constexpr std::int64_t kSearchGrain = 256;

/// Triangles that are smaller than this share of the mean edge (of either side, the smaller) are not quartered.
constexpr double kSmallest = 0.25;

/// A point and the triangle of the tree that is nearest to it.
struct Probe {
  Vec3 point;
  Index leaf_place = 0;  ///< of that triangle
  double distance = 0;
};

/// Square of the height over the longest side: below, quarters come as thin as the triangle is.
constexpr double kThin = 0.1 * 0.1;

class Search {
 public:
  /// lower: a distance known to be reached. smallest: triangles with shorter edges are not quartered, m.
  Search(const TriangleTree& tree, double lower, double smallest, double tolerance = kFarthestTolerance)
      : tree_(tree), best_(lower), smallest_(smallest), tolerance_(tolerance) {}

  /// guess: a place in the tree that may be near; -1: none.
  static Probe probe(const TriangleTree& tree, const Vec3& point, Index guess) {
    const TriangleTree::Nearest found = tree.nearest_from(point, guess);
    return {point, found.place, std::sqrt(found.squared_distance)};
  }

  double best() const { return best_; }

  void visit(const Probe& a, const Probe& b, const Probe& c) {
    best_ = std::max({best_, a.distance, b.distance, c.distance});
    const double longest = std::sqrt(std::max(
        {(a.point - b.point).squaredNorm(), (b.point - c.point).squaredNorm(), (c.point - a.point).squaredNorm()}));
    if (!(longest > smallest_)) return;
    // Every point is within longest / sqrt(3) of a corner, and no farther from the tree than the corner by more.
    const double enough = best_ * (1 + tolerance_);
    if (std::max({a.distance, b.distance, c.distance}) + 0.578 * longest <= enough) return;
    if (upper_bound(a, b, c) <= enough) return;
    divide(a, b, c, [this](const Probe& p, const Probe& q, const Probe& r) { visit(p, q, r); });
  }

  /// Appends corners that are further away than the lower bound, or points between them if no corner is.
  void collect(const Probe& a, const Probe& b, const Probe& c, std::vector<Vec3>& far) const {
    const std::size_t before = far.size();
    for (const Probe* p : {&a, &b, &c})
      if (p->distance > best_) far.push_back(p->point);
    const double longest = std::sqrt(std::max(
        {(a.point - b.point).squaredNorm(), (b.point - c.point).squaredNorm(), (c.point - a.point).squaredNorm()}));
    if (far.size() > before || !(longest > smallest_)) return;
    if (std::max({a.distance, b.distance, c.distance}) + 0.578 * longest <= best_) return;
    if (upper_bound(a, b, c) <= best_) return;
    divide(a, b, c, [&](const Probe& p, const Probe& q, const Probe& r) { collect(p, q, r, far); });
  }

 private:
  /// Into quarters; where those would be as thin as it is, into halves of its longest side.
  template <typename Take>
  void divide(const Probe& a, const Probe& b, const Probe& c, const Take& take) const {
    const auto length2 = [](const Probe& p, const Probe& q) { return (p.point - q.point).squaredNorm(); };
    const double ab2 = length2(a, b), bc2 = length2(b, c), ca2 = length2(c, a);
    const double longest2 = std::max({ab2, bc2, ca2});
    const double height2 = (b.point - a.point).cross(c.point - a.point).squaredNorm() / longest2;
    if (height2 < kThin * longest2) {
      if (longest2 == ab2) return halve(a, b, c, take);
      return longest2 == bc2 ? halve(b, c, a, take) : halve(c, a, b, take);
    }
    const Probe ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    take(a, ab, ca);
    take(ab, b, bc);
    take(ca, bc, c);
    take(ab, bc, ca);
  }
  template <typename Take>
  void halve(const Probe& a, const Probe& b, const Probe& c, const Take& take) const {
    const Probe between = middle(a, b);
    take(a, between, c);
    take(between, b, c);
  }

  Probe middle(const Probe& a, const Probe& b) const { return probe(tree_, 0.5 * (a.point + b.point), a.leaf_place); }

  double upper_bound(const Probe& a, const Probe& b, const Probe& c) const {
    double least = 1e300;
    for (const Probe* of : {&a, &b, &c}) {
      const auto& [x, y, z] = tree_.corners(of->leaf_place);
      double most = 0;
      for (const Probe* p : {&a, &b, &c})
        most = std::max(most, (nearest_on_triangle(p->point, x, y, z) - p->point).squaredNorm());
      least = std::min(least, most);
    }
    return std::sqrt(least);
  }

  const TriangleTree& tree_;
  double best_, smallest_, tolerance_;
};

double edge_sum(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (a - b).norm() + (b - c).norm() + (c - a).norm();
}

/// The smaller of the mean edges of both sides, m.
double mean_edge(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, const TriangleTree& tree) {
  double own = 0, other = 0;
  for (const auto& [a, b, c] : triangles)
    own += edge_sum(points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)],
                    points[static_cast<std::size_t>(c)]);
  for (std::size_t place = 0; place < tree.order().size(); ++place) {
    const auto& [a, b, c] = tree.corners(static_cast<Index>(place));
    other += edge_sum(a, b, c);
  }
  return std::min(own / static_cast<double>(triangles.size()), other / static_cast<double>(tree.order().size())) / 3;
}

/// Nearest places of all points that a triangle uses.
std::vector<Probe> probe_points(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                const TriangleTree& tree, const Threads& threads) {
  std::vector<bool> used(points.size(), false);
  for (const Triangle& triangle : triangles)
    for (const Index v : triangle) used[static_cast<std::size_t>(v)] = true;
  std::vector<Probe> probes(points.size());
  threads.for_chunks(static_cast<std::int64_t>(points.size()), kSearchGrain, [&](std::int64_t begin, std::int64_t end) {
    Index guess = -1;
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
      if (!used[v]) continue;
      probes[v] = Search::probe(tree, points[v], guess);
      guess = probes[v].leaf_place;
    }
  });
  return probes;
}

}  // namespace

double farthest_distance(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                         const TriangleTree& tree, const Threads& threads) {
  if (tree.empty() || triangles.empty()) return 0;
  const std::vector<Probe> probes = probe_points(points, triangles, tree, threads);
  double lower = 0;
  for (const Probe& probe : probes) lower = std::max(lower, probe.distance);
  const double smallest = kSmallest * mean_edge(points, triangles, tree);
  const auto n = static_cast<std::int64_t>(triangles.size());
  std::vector<double> farthest(static_cast<std::size_t>((n + kSearchGrain - 1) / kSearchGrain), lower);
  threads.for_chunks(n, kSearchGrain, [&](std::int64_t begin, std::int64_t end) {
    Search search(tree, lower, smallest);
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      const auto corner = [&](std::size_t k) { return probes[static_cast<std::size_t>(triangles[t][k])]; };
      search.visit(corner(0), corner(1), corner(2));
    }
    farthest[static_cast<std::size_t>(begin / kSearchGrain)] = search.best();
  });
  return *std::max_element(farthest.begin(), farthest.end());
}

double farthest_of_triangle(const std::array<Vec3, 3>& corners, const TriangleTree& tree, double lower, double smallest,
                            double tolerance) {
  Search search(tree, lower, smallest, tolerance);
  search.visit(Search::probe(tree, corners[0], -1), Search::probe(tree, corners[1], -1),
               Search::probe(tree, corners[2], -1));
  return search.best();
}

namespace {

/// Calls with(triangle, its far points) for all triangles, each chunk of them in order.
template <typename With>
void visit_far(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, const TriangleTree& tree,
               double limit, const Threads& threads, const With& with) {
  const std::vector<Probe> probes = probe_points(points, triangles, tree, threads);
  const Search search(tree, limit, kSmallest * mean_edge(points, triangles, tree));
  threads.for_chunks(
      static_cast<std::int64_t>(triangles.size()), kSearchGrain, [&](std::int64_t begin, std::int64_t end) {
        std::vector<Vec3> far;
        for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
          const auto corner = [&](std::size_t k) { return probes[static_cast<std::size_t>(triangles[t][k])]; };
          far.clear();
          search.collect(corner(0), corner(1), corner(2), far);
          with(t, far);
        }
      });
}

}  // namespace

std::vector<Vec3> find_far_points(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                  const TriangleTree& tree, double limit, const Threads& threads) {
  if (tree.empty() || triangles.empty()) return {};
  const auto n = static_cast<std::int64_t>(triangles.size());
  std::vector<std::vector<Vec3>> chunks(static_cast<std::size_t>((n + kSearchGrain - 1) / kSearchGrain));
  visit_far(points, triangles, tree, limit, threads, [&](std::size_t t, const std::vector<Vec3>& of_triangle) {
    std::vector<Vec3>& chunk = chunks[t / static_cast<std::size_t>(kSearchGrain)];
    chunk.insert(chunk.end(), of_triangle.begin(), of_triangle.end());
  });
  std::vector<Vec3> far;
  for (const std::vector<Vec3>& chunk : chunks) far.insert(far.end(), chunk.begin(), chunk.end());
  return far;
}

std::vector<std::uint8_t> find_far_triangles(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                             const TriangleTree& tree, double limit, const Threads& threads) {
  std::vector<std::uint8_t> far(triangles.size(), 0);
  if (tree.empty() || triangles.empty()) return far;
  visit_far(points, triangles, tree, limit, threads,
            [&](std::size_t t, const std::vector<Vec3>& of_triangle) { far[t] = of_triangle.empty() ? 0 : 1; });
  return far;
}

}  // namespace softreel
