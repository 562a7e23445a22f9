#include "core/tetmesh/improvement/boundary_slide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/tetmesh/farthest_point.h"
#include "core/tetmesh/improvement/triangle_samples.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 256;

/// Shares of a mean boundary edge: samples of the surface are so far apart; less is round-off; nodes nearer than that
/// to the surface are on it.
constexpr double kSampleStep = 0.25, kNothing = 1e-6, kTouching = 0.03;

/// Between the samples the surface may be further away: samples stay below this share of the largest distance of any.
constexpr double kNearlyLargest = 0.9;

/// Parts of faces are not looked into below this share of the mean edge, of faces or of the surface, the smaller.
constexpr double kSmallestPart = 0.25;

Vec3 area_vector(const std::array<Vec3, 3>& x) {
  return 0.5 * (x[1] - x[0]).cross(x[2] - x[0]);
}

double mean_edge(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& triangle : triangles)
    for (std::size_t k = 0; k < 3; ++k) sum += (points[at(triangle[k])] - points[at(triangle[(k + 1) % 3])]).norm();
  return sum / (3.0 * static_cast<double>(triangles.size()));
}

}  // namespace

BoundarySlide::BoundarySlide(const std::vector<Vec3>& nodes, std::vector<Triangle> faces, const SurfaceMesh& surface,
                             const Threads& threads)
    : nodes_(nodes), faces_(std::move(faces)), tree_(surface.positions, surface.triangles) {
  list_fans();
  const double edge = mean_edge(nodes_, faces_);
  assign_samples(surface, kSampleStep * edge, threads);
  double largest = 0;
  for (const auto& samples : samples_)
    for (const Sample& sample : samples) largest = std::max(largest, sample.squared);
  nothing_ = kNothing * edge;
  largest_ = std::max(nothing_, kNearlyLargest * std::sqrt(largest));
  touching_ = kTouching * edge;
  smallest_ = kSmallestPart * std::min(edge, mean_edge(surface.positions, surface.triangles));
}

void BoundarySlide::list_fans() {
  fan_offsets_.assign(nodes_.size() + 1, 0);
  for (const Triangle& face : faces_)
    for (const Index node : face) ++fan_offsets_[at(node) + 1];
  std::partial_sum(fan_offsets_.begin(), fan_offsets_.end(), fan_offsets_.begin());
  fan_items_.resize(at(fan_offsets_.back()));
  std::vector<Index> next(fan_offsets_.begin(), fan_offsets_.end() - 1);
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (const Index node : faces_[f]) fan_items_[at(next[at(node)]++)] = static_cast<Index>(f);
}

std::span<const Index> BoundarySlide::fan(Index node) const {
  const Index begin = fan_offsets_[at(node)], end = fan_offsets_[at(node) + 1];
  return {fan_items_.data() + begin, at(end - begin)};
}

BoundarySlide::Corners BoundarySlide::corners(Index face, Index moved_node, const Vec3& to) const {
  Corners x;
  for (std::size_t k = 0; k < 3; ++k) {
    const Index node = faces_[at(face)][k];
    x[k] = node == moved_node ? to : nodes_[at(node)];
  }
  return x;
}

void BoundarySlide::assign_samples(const SurfaceMesh& surface, double step, const Threads& threads) {
  const std::vector<Vec3> points = sample_triangles(surface.positions, surface.triangles, step);
  const TriangleTree boundary(nodes_, faces_);
  std::vector<TriangleTree::Nearest> found(points.size());
  threads.for_chunks(static_cast<std::int64_t>(points.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      found[i] = boundary.nearest(points[i]);
  });
  samples_.resize(faces_.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    samples_[at(found[i].triangle)].push_back({points[i], found[i].squared_distance});
}

Vec3 BoundarySlide::normal(Index node) const {
  Vec3 sum = Vec3::Zero();
  for (const Index face : fan(node)) sum += area_vector(corners(face, -1, {}));
  return sum.normalized();
}

Vec3 BoundarySlide::place(Index node, const Vec3& p) const {
  const auto any = [](Index, const Vec3&) { return true; };
  return tree_.nearest(nodes_[at(node)], touching_ * touching_, any).triangle >= 0 ? tree_.nearest(p).point : p;
}

BoundarySlide::Distances BoundarySlide::distances(Index node) const {
  Distances now{nothing_, nothing_ * nothing_};
  for (const Index face : fan(node)) {
    now.faces = farthest_of_triangle(corners(face, -1, {}), tree_, now.faces, smallest_, kFarthestTolerance);
    for (const Sample& sample : samples_[at(face)]) now.squared_samples = std::max(now.squared_samples, sample.squared);
  }
  now.squared_samples = std::min(now.squared_samples, largest_ * largest_);
  return now;
}

bool BoundarySlide::keeps(Index node, const Vec3& to, const Distances& distances) const {
  std::vector<Corners> faces;
  for (const Index face : fan(node)) faces.push_back(corners(face, node, to));
  const auto is_near = [&](const Sample& sample) {
    return std::ranges::any_of(faces, [&](const Corners& x) {
      return (nearest_on_triangle(sample.point, x[0], x[1], x[2]) - sample.point).squaredNorm() <=
             distances.squared_samples;
    });
  };
  return std::ranges::all_of(fan(node), [&](Index face) { return std::ranges::all_of(samples_[at(face)], is_near); }) &&
         std::ranges::all_of(faces, [&](const Corners& x) {
           return farthest_of_triangle(x, tree_, distances.faces, smallest_, 0) <= distances.faces;
         });
}

void BoundarySlide::give_to_nearest(const Sample& sample, std::span<const Index> faces) {
  Index nearest = -1;
  double least = std::numeric_limits<double>::max();
  for (const Index face : faces) {
    const auto [a, b, c] = corners(face, -1, {});
    const double squared = (nearest_on_triangle(sample.point, a, b, c) - sample.point).squaredNorm();
    if (nearest >= 0 && squared >= least) continue;
    nearest = face;
    least = squared;
  }
  samples_[at(nearest)].push_back({sample.point, least});
}

void BoundarySlide::moved(Index node) {
  std::vector<Sample> samples;
  for (const Index face : fan(node)) {
    samples.insert(samples.end(), samples_[at(face)].begin(), samples_[at(face)].end());
    samples_[at(face)].clear();
  }
  for (const Sample& sample : samples) give_to_nearest(sample, fan(node));
}

}  // namespace softreel
