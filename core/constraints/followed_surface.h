/// An animated surface as what points follow: each hangs on a triangle.
#pragma once

#include <memory>

#include "core/constraints/followed_motion.h"
#include "core/mesh/animated_vertices.h"
#include "core/mesh/placement.h"

namespace softreel {

/// A point keeps the weights of its triangle's corners, and its distance from there in the frame of the triangle: two
/// edges and the normal, whose length is the square root of theirs spanned, so that it grows with the triangle.
class FollowedSurface : public FollowedMotion {
 public:
  /// Which triangle a point hangs on.
  enum class Binding {
    Nearest,  ///< the nearest one at the reference
    Vertex    ///< one that has the vertex of the point's number: the followed vertices are those of the body
  };

  /// reference: the vertices in the scene where points are at rest; triangles: of these vertices. placement: from the
  /// animation's axes and unit to the scene. Throws input_error if every triangle is flat at the reference.
  FollowedSurface(std::shared_ptr<const AnimatedVertices> vertices, std::vector<Vec3> reference,
                  std::vector<Triangle> triangles, Binding binding, const ClipTiming& timing,
                  const Placement& placement);

  std::vector<FollowTie> tie(std::span<const Vec3> points, std::span<const Index> vertices) const override;
  double farthest_from(std::span<const Vec3> points, std::span<const FollowTie> ties) const override;
  std::vector<LocalMotion> motions(std::span<const FollowTie> ties, double frame) const override;
  std::vector<double> pose(double frame) const override { return vertices_->pose(timing_.seconds(frame)); }
  std::uint64_t content() const override;

 private:
  std::vector<FollowTie> tie_to_nearest(std::span<const Vec3> points) const;
  std::vector<FollowTie> tie_to_vertices(std::span<const Index> vertices) const;

  std::shared_ptr<const AnimatedVertices> vertices_;
  std::vector<Vec3> reference_;
  std::vector<Triangle> triangles_;  ///< those that are not flat at the reference
  Binding binding_;
  ClipTiming timing_;
  Placement placement_;
};

}  // namespace softreel
