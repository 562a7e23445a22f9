#include "render/pathtrace/rays/scene_rays.h"

#include <array>

namespace softreel {

namespace {

/// Those rays of a packet that may meet bodies.
struct RayPart {
  std::array<Ray, kRayPacket> rays;
  std::array<std::size_t, kRayPacket> places{};  ///< in the packet
  std::size_t count = 0;

  void add(const Ray& ray, std::size_t place) {
    places[count] = place;
    rays[count++] = ray;
  }
  std::span<const Ray> shot() const { return {rays.data(), count}; }
};

}  // namespace

void MotionBox::add(const MotionMesh& mesh) {
  Vec3f least = low, most = high;
  for (const MotionMesh::Time& time : mesh.times)
    for (const Vec3f& p : time.positions) {
      least = least.cwiseMin(p);
      most = most.cwiseMax(p);
    }
  if (!(least.x() <= most.x())) return;
  const float margin = 1e-5f * std::max(least.cwiseAbs().maxCoeff(), most.cwiseAbs().maxCoeff());
  low = low.cwiseMin(least - Vec3f::Constant(margin));
  high = high.cwiseMax(most + Vec3f::Constant(margin));
}

SceneRays::SceneRays(const RayScene& trees, const std::vector<const MotionMesh*>& bodies, const GroundShape& ground)
    : trees_(trees), ground_(ground), ground_mesh_(static_cast<Index>(bodies.size())) {
  for (const MotionMesh* body : bodies) bodies_.add(*body);
}

bool SceneRays::intersect(const Ray& ray, RayHit& hit) const {
  if (!ground_) return trees_.intersect(ray, hit);
  const bool on_ground = ground_->intersect(ray, hit);
  if (on_ground) hit.mesh = ground_mesh_;
  if (!bodies_.may_meet(ray)) return on_ground;
  return trees_.intersect(on_ground ? before_ground(ray, hit) : ray, hit) || on_ground;
}

bool SceneRays::occluded(const Ray& ray) const {
  if (!ground_) return trees_.occluded(ray);
  if (bodies_.may_meet(ray) && trees_.occluded(ray)) return true;
  return ground_->blocks(ray);
}

void SceneRays::intersect_packet(std::span<const Ray> rays, std::span<RayHit> hits) const {
  if (!ground_) return trees_.intersect_packet(rays, hits);
  RayPart part;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const bool on_ground = ground_->intersect(rays[k], hits[k]);
    hits[k].mesh = on_ground ? ground_mesh_ : -1;
    if (!bodies_.may_meet(rays[k])) continue;
    part.add(on_ground ? before_ground(rays[k], hits[k]) : rays[k], k);
  }
  if (part.count == 0) return;
  std::array<RayHit, kRayPacket> found;
  trees_.intersect_packet(part.shot(), {found.data(), part.count});
  for (std::size_t j = 0; j < part.count; ++j)
    if (found[j].mesh >= 0) hits[part.places[j]] = found[j];
}

}  // namespace softreel
