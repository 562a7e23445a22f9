/// Rays at all that a picture shows: trees of bodies, and the ground.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "render/pathtrace/rays/ray_scene.h"
#include "render/pathtrace/rays/swept_ground.h"

namespace softreel {

/// Axis-parallel box round meshes at all their times, a little larger, so that rounding loses no ray.
struct MotionBox {
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::infinity()), high = -low;

  void add(const MotionMesh& mesh);
  /// Whether a ray may meet what is inside.
  bool may_meet(const Ray& ray) const {
    float enters = 0, leaves = ray.max_distance;
    for (int k = 0; k < 3; ++k) {
      const float inverse = 1 / ray.direction[k];
      const float a = (low[k] - ray.origin[k]) * inverse, b = (high[k] - ray.origin[k]) * inverse;
      // Written so that 0 times infinity, of a ray within a face's plane, changes nothing.
      enters = std::max(enters, std::min(a, b));
      leaves = std::min(leaves, std::max(a, b));
    }
    return enters <= leaves;
  }
};

/// The meshes of a picture for rays. Queries are thread-safe.
class SceneRays {
 public:
  /// Only trees, of whatever they hold.
  explicit SceneRays(const RayScene& trees) : trees_(trees) {}
  /// Trees of `bodies`, and the ground as mesh number bodies.size().
  SceneRays(const RayScene& trees, const std::vector<const MotionMesh*>& bodies, const GroundShape& ground);

  const RayScene& trees() const { return trees_; }
  /// As RayScene's.
  bool intersect(const Ray& ray, RayHit& hit) const;
  bool occluded(const Ray& ray) const;
  void intersect_packet(std::span<const Ray> rays, std::span<RayHit> hits) const;
  /// Whether a hit's mesh is the ground that no tree holds: then its triangle is none of a mesh.
  bool is_ground(Index mesh) const { return mesh == ground_mesh_; }
  /// Of a point of a body; Beyond where the ground is none or in the trees, as one that scatters light inside is.
  FloorSide side_of_floor(const Vec3f& position) const {
    return ground_ ? ground_->side_of_floor(position) : FloorSide::Beyond;
  }
  /// Where `ray` hit; mesh: the one of that number.
  SurfacePoint surface_point(const MotionMesh& mesh, const RayHit& hit, const Ray& ray) const {
    return is_ground(hit.mesh) ? ground_->surface_point(hit, ray) : softreel::surface_point(mesh, hit, ray);
  }

 private:
  /// The part of a ray that hit the ground in which it may hit bodies.
  Ray before_ground(const Ray& ray, const RayHit& hit) const {
    Ray nearer = ray;
    nearer.max_distance = std::max(0.0f, hit.distance - ground_->depth_of_burial(hit, ray));
    return nearer;
  }

  const RayScene& trees_;
  std::optional<SweptGround> ground_;
  Index ground_mesh_ = -2;  ///< of none; -1 is that of no hit
  MotionBox bodies_;        ///< with a ground only: without one most rays meet it
};

}  // namespace softreel
