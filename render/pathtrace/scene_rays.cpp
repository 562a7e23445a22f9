#include "render/pathtrace/scene_rays.h"

namespace softreel {

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

SceneRays::SceneRays(const RayScene& trees, const std::vector<const MotionMesh*>& bodies, const MotionMesh& ground)
    : trees_(trees), ground_(ground), ground_mesh_(static_cast<Index>(bodies.size())) {
  for (const MotionMesh* body : bodies) bodies_.add(*body);
}

bool SceneRays::intersect(const Ray& ray, RayHit& hit, bool coherent) const {
  if (!ground_) return trees_.intersect(ray, hit, coherent);
  const bool on_ground = ground_->intersect(ray, hit);
  if (on_ground) hit.mesh = ground_mesh_;
  if (!bodies_.may_meet(ray)) return on_ground;
  Ray nearer = ray;
  if (on_ground) nearer.max_distance = hit.distance;
  return trees_.intersect(nearer, hit, coherent) || on_ground;
}

bool SceneRays::occluded(const Ray& ray, bool coherent) const {
  if (!ground_) return trees_.occluded(ray, coherent);
  if (bodies_.may_meet(ray) && trees_.occluded(ray, coherent)) return true;
  return ground_->blocks(ray);
}

}  // namespace softreel
