#include "core/tetmesh/improvement/boundary_slide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/tetmesh/improvement/triangle_samples.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 256;

/// A node is on a crease if a face there is turned from the mean by more than 30 degrees.
constexpr double kCreaseCosine = 0.866;

/// Samples of the surface are this share of a mean boundary edge apart; distances below kNothing of it are round-off.
constexpr double kSampleStep = 0.5, kNothing = 1e-6;

/// Samples see a little less than the largest distance: what they see stays below this share of it.
constexpr double kNearlyLargest = 0.9;

/// A face is sampled at the points of a grid of so many steps along each edge.
constexpr int kFaceSteps = 4;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

Vec3 area_vector(const std::array<Vec3, 3>& x) {
  return 0.5 * (x[1] - x[0]).cross(x[2] - x[0]);
}

bool any(Index, const Vec3&) {
  return true;
}

}  // namespace

BoundarySlide::BoundarySlide(const std::vector<Vec3>& nodes, std::vector<Triangle> faces, const SurfaceMesh& surface,
                             double good_share, const Threads& threads)
    : nodes_(nodes), faces_(std::move(faces)), tree_(surface.positions, surface.triangles) {
  list_fans();
  const double edge = mean_edge();
  assign_samples(surface, kSampleStep * edge, threads);
  double farthest = farthest_face(threads);
  for (const auto& samples : samples_)
    for (const Sample& sample : samples) farthest = std::max(farthest, sample.squared);
  nothing_ = std::pow(kNothing * edge, 2);
  good_ = std::max(nothing_, good_share * good_share * farthest);
  bad_ = std::max(nothing_, kNearlyLargest * kNearlyLargest * farthest);
  find_freedom();
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

double BoundarySlide::mean_edge() const {
  double sum = 0;
  for (const Triangle& face : faces_)
    for (std::size_t k = 0; k < 3; ++k) sum += (nodes_[at(face[k])] - nodes_[at(face[(k + 1) % 3])]).norm();
  return sum / (3.0 * static_cast<double>(faces_.size()));
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

/// Largest squared distance of the samples of a face to the surface; 0 if all are nearer than `enough`.
double BoundarySlide::face_error(const Corners& x, double enough) const {
  double error = 0;
  for (int i = 0; i <= kFaceSteps; ++i)
    for (int j = 0; i + j <= kFaceSteps; ++j) {
      const double u = static_cast<double>(i) / kFaceSteps, v = static_cast<double>(j) / kFaceSteps;
      const Vec3 p = (1 - u - v) * x[0] + u * x[1] + v * x[2];
      const double seen = std::max(enough, error);
      if (seen > 0 && tree_.nearest(p, seen, any).triangle >= 0) continue;
      error = std::max(error, tree_.nearest(p).squared_distance);
    }
  return error;
}

/// Largest squared distance of the samples of all faces. Each chunk looks for what is farther than it has seen.
double BoundarySlide::farthest_face(const Threads& threads) const {
  const auto count = static_cast<std::int64_t>(faces_.size());
  std::vector<double> farthest(faces_.size() / kGrain + 1, 0.0);
  threads.for_chunks(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
    double& error = farthest[static_cast<std::size_t>(begin / kGrain)];
    for (std::int64_t f = begin; f < end; ++f)
      error = std::max(error, face_error(corners(static_cast<Index>(f), -1, {}), error));
  });
  return *std::ranges::max_element(farthest);
}

void BoundarySlide::find_freedom() {
  freedom_.assign(nodes_.size(), Freedom::Inside);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto node = static_cast<Index>(i);
    if (fan(node).empty()) continue;
    const Vec3 mean = normal(node);
    const bool smooth = std::ranges::all_of(fan(node), [&](Index face) {
      const Vec3 area = area_vector(corners(face, -1, {}));
      return area.dot(mean) > kCreaseCosine * area.norm();
    });
    const bool is_near = tree_.nearest(nodes_[i], good_, any).triangle >= 0;
    freedom_[i] = !is_near ? Freedom::Beside : smooth ? Freedom::Smooth : Freedom::Crease;
  }
}

Vec3 BoundarySlide::normal(Index node) const {
  Vec3 sum = Vec3::Zero();
  for (const Index face : fan(node)) sum += area_vector(corners(face, -1, {}));
  return sum.normalized();
}

Vec3 BoundarySlide::place(Index node, const Vec3& p) const {
  return freedom_[at(node)] == Freedom::Beside ? p : tree_.nearest(p).point;
}

bool BoundarySlide::keeps_samples(Index node, const Vec3& to, double good) const {
  double before = good, after = 0;
  for (const Index face : fan(node))
    for (const Sample& sample : samples_[at(face)]) {
      double squared = std::numeric_limits<double>::max();
      for (const Index other : fan(node)) {
        const auto [a, b, c] = corners(other, node, to);
        squared = std::min(squared, (nearest_on_triangle(sample.point, a, b, c) - sample.point).squaredNorm());
      }
      before = std::max(before, sample.squared);
      after = std::max(after, squared);
    }
  return after <= std::min(before, bad_);
}

double BoundarySlide::fan_error(Index node, const Vec3& at_node, double enough) const {
  double error = 0;
  for (const Index face : fan(node)) error = std::max(error, face_error(corners(face, node, at_node), enough));
  return error;
}

bool BoundarySlide::keeps_faces(Index node, const Vec3& to, double good) const {
  const double after = fan_error(node, to, good);
  return after == 0 || after <= std::min(bad_, fan_error(node, nodes_[at(node)], good));
}

bool BoundarySlide::keeps_distance(Index node, const Vec3& to) const {
  const double good = freedom_[at(node)] == Freedom::Smooth ? good_ : nothing_;
  return keeps_samples(node, to, good) && keeps_faces(node, to, good);
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
