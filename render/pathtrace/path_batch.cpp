#include "render/pathtrace/path_batch.h"

namespace softreel {

void PathBatch::trace() {
  alive_.clear();
  for (PathIntegrator& path : paths_) alive_.push_back(&path);
  for (bool first = true; !alive_.empty(); first = false) {
    shoot_rays(first);
    prefetch_hit_corners();
    for (std::size_t k = 0; k < alive_.size(); ++k) {
      if (hits_[k].mesh < 0)
        alive_[k]->miss();
      else
        alive_[k]->arrive(hits_[k], scratch_);
    }
    shoot_light_rays();
    std::erase_if(alive_, [](const PathIntegrator* path) { return !path->lives_on(); });
  }
}

void PathBatch::shoot_rays(bool together) {
  if (together) {
    for (std::size_t first = 0; first < alive_.size(); first += kRayPacket) {
      const std::size_t count = std::min(kRayPacket, alive_.size() - first);
      std::array<Ray, kRayPacket> rays;
      for (std::size_t k = 0; k < count; ++k) rays[k] = alive_[first + k]->ray();
      picture_.rays->intersect_packet({rays.data(), count}, {hits_.data() + first, count});
      for (std::size_t k = first; k < first + count; ++k) prefetch_hit_triangle(hits_[k]);
    }
    return;
  }
  std::erase_if(alive_, [](PathIntegrator* path) {
    if (path->is_on_last_ray()) path->end_on_last_ray();
    return !path->lives_on();
  });
  for (std::size_t k = 0; k < alive_.size(); ++k) {
    if (!picture_.rays->intersect(alive_[k]->ray(), hits_[k])) hits_[k].mesh = -1;
    prefetch_hit_triangle(hits_[k]);
  }
}

void PathBatch::prefetch_hit_triangle(const RayHit& hit) const {
  if (hit.mesh >= 0) prefetch_triangle(*picture_.meshes[static_cast<std::size_t>(hit.mesh)], hit);
}

void PathBatch::prefetch_hit_corners() const {
  for (std::size_t k = 0; k < alive_.size(); ++k)
    if (hits_[k].mesh >= 0)
      prefetch_corners(*picture_.meshes[static_cast<std::size_t>(hits_[k].mesh)], hits_[k], alive_[k]->ray());
}

void PathBatch::shoot_light_rays() {
  for (const PathScratch::LightRay& one : scratch_.light_rays)
    if (!picture_.rays->occluded(one.ray)) paths_[one.path].gain(one.part);
  scratch_.light_rays.clear();
}

}  // namespace softreel
