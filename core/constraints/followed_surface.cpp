#include "core/constraints/followed_surface.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/fingerprint.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

/// A triangle is flat if its area is below this share of its longest edge's square.
constexpr double kFlatTriangle = 1e-9;

using Corners = std::array<Vec3, 3>;

Vec3 weighted(const Corners& corners, const Vec3& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

bool is_flat(const Corners& corners) {
  const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[0];
  const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
  return !(a.cross(b).norm() > kFlatTriangle * longest);
}

/// Two edges and the normal, in columns.
Mat3 frame_of(const Corners& corners) {
  Mat3 frame;
  frame.col(0) = corners[1] - corners[0];
  frame.col(1) = corners[2] - corners[0];
  const Vec3 normal = frame.col(0).cross(frame.col(1));
  frame.col(2) = normal / std::sqrt(std::max(normal.norm(), 1e-300));
  return frame;
}

/// Weights of the triangle's corners for a point in its plane, not outside of it.
Vec3 weights_in(const Corners& corners, const Vec3& point) {
  const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[0], p = point - corners[0];
  const Vec3 normal = a.cross(b);
  const double second = p.cross(b).dot(normal) / normal.squaredNorm();
  const double third = a.cross(p).dot(normal) / normal.squaredNorm();
  return {1 - second - third, second, third};
}

Corners corners_of(const Triangle& triangle, const std::vector<Vec3>& positions) {
  return {positions[static_cast<std::size_t>(triangle[0])], positions[static_cast<std::size_t>(triangle[1])],
          positions[static_cast<std::size_t>(triangle[2])]};
}

}  // namespace

FollowedSurface::FollowedSurface(std::shared_ptr<const AnimatedVertices> vertices, std::vector<Vec3> reference,
                                 std::vector<Triangle> triangles, Binding binding, const ClipTiming& timing,
                                 const Placement& placement)
    : vertices_(std::move(vertices)),
      reference_(std::move(reference)),
      triangles_(std::move(triangles)),
      binding_(binding),
      timing_(timing),
      placement_(placement) {
  std::erase_if(triangles_, [&](const Triangle& t) { return is_flat(corners_of(t, reference_)); });
  if (triangles_.empty())
    throw input_error(
        "what is followed has no triangle with an area where points are to hang on it.\n  Accepted: a surface. Choose "
        "another mesh or reference frame.");
}

std::vector<FollowTie> FollowedSurface::tie(std::span<const Vec3> points, std::span<const Index> vertices) const {
  return binding_ == Binding::Vertex ? tie_to_vertices(vertices) : tie_to_nearest(points);
}

std::vector<FollowTie> FollowedSurface::tie_to_nearest(std::span<const Vec3> points) const {
  const TriangleTree tree(reference_, triangles_);
  std::vector<FollowTie> ties;
  for (const Vec3& point : points) {
    const TriangleTree::Nearest nearest = tree.nearest(point);
    const Triangle& triangle = triangles_[static_cast<std::size_t>(std::max<Index>(nearest.triangle, 0))];
    ties.push_back({triangle, weights_in(corners_of(triangle, reference_), nearest.point)});
  }
  return ties;
}

/// The corner comes first and has all of the weight. A vertex of flat triangles only hangs on itself.
std::vector<FollowTie> FollowedSurface::tie_to_vertices(std::span<const Index> vertices) const {
  std::vector<Index> triangle_of(reference_.size(), -1);
  for (std::size_t t = triangles_.size(); t-- > 0;)
    for (const Index v : triangles_[t]) triangle_of[static_cast<std::size_t>(v)] = static_cast<Index>(t);
  std::vector<FollowTie> ties;
  for (const Index v : vertices) {
    FollowTie tie{{v, v, v}, Vec3(1, 0, 0)};
    if (const Index t = triangle_of[static_cast<std::size_t>(v)]; t >= 0) {
      tie.vertices = triangles_[static_cast<std::size_t>(t)];
      std::rotate(tie.vertices.begin(), std::find(tie.vertices.begin(), tie.vertices.end(), v), tie.vertices.end());
    }
    ties.push_back(tie);
  }
  return ties;
}

double FollowedSurface::farthest_from(std::span<const Vec3> points, std::span<const FollowTie> ties) const {
  double farthest = 0;
  if (binding_ != Binding::Nearest) return farthest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 hung = weighted(corners_of(ties[i].vertices, reference_), ties[i].weights);
    farthest = std::max(farthest, (points[i] - hung).norm());
  }
  return farthest;
}

std::vector<LocalMotion> FollowedSurface::motions(std::span<const FollowTie> ties, double frame) const {
  std::vector<Index> corners;
  for (const FollowTie& tie : ties) corners.insert(corners.end(), tie.vertices.begin(), tie.vertices.end());
  const std::vector<Vec3> moved = vertices_->at(timing_.seconds(frame), corners);
  std::vector<LocalMotion> motions;
  motions.reserve(ties.size());
  for (std::size_t i = 0; i < ties.size(); ++i) {
    const Corners rest = corners_of(ties[i].vertices, reference_);
    const Corners now{placement_(moved[3 * i]), placement_(moved[3 * i + 1]), placement_(moved[3 * i + 2])};
    LocalMotion& motion = motions.emplace_back();
    motion.from = weighted(rest, ties[i].weights);
    motion.to = weighted(now, ties[i].weights);
    if (now != rest && !is_flat(rest)) motion.linear = frame_of(now) * frame_of(rest).inverse();
  }
  return motions;
}

std::uint64_t FollowedSurface::content() const {
  return Fingerprint()
      .add(vertices_->content())
      .add(std::span<const Vec3>(reference_))
      .add(std::span<const Triangle>(triangles_))
      .add(static_cast<Index>(binding_))
      .add(placement_.linear)
      .add(placement_.offset)
      .value();
}

}  // namespace softreel
