#include "render/pathtrace/path_group.h"

#include <algorithm>

namespace softreel {

void PathGroup::trace() {
  alive_.clear();
  for (PathIntegrator& path : paths_) alive_.push_back(&path);
  shoot_camera_rays();
  scatter();
  while (!alive_.empty()) {
    end_last_rays();
    shoot_rays();
    scatter();
  }
}

void PathGroup::shoot_camera_rays() {
  std::array<Ray, kRayPacket> rays;
  for (std::size_t first = 0, end = 0; first < paths_.size(); first = end) {
    for (; end < paths_.size() && packets_[end] == packets_[first]; ++end) {
      CHECK(end - first < kRayPacket);
      rays[end - first] = paths_[end].ray();
    }
    if (end - first == 1)
      shoot_ray(first);  // a packet of one takes longer
    else
      picture_.rays->intersect_packet({rays.data(), end - first}, {hits_.data() + first, end - first});
    for (std::size_t k = first; k < end; ++k) prefetch_hit_triangle(hits_[k]);
  }
}

void PathGroup::shoot_rays() {
  for (std::size_t k = 0; k < alive_.size(); ++k) {
    shoot_ray(k);
    prefetch_hit_triangle(hits_[k]);
  }
}

void PathGroup::shoot_ray(std::size_t k) {
  if (!picture_.rays->intersect(alive_[k]->ray(), hits_[k])) hits_[k].mesh = -1;
}

void PathGroup::scatter() {
  prefetch_hit_corners();
  for (std::size_t k = 0; k < alive_.size(); ++k) {
    if (hits_[k].mesh < 0)
      alive_[k]->miss();
    else
      alive_[k]->arrive(hits_[k], scratch_);
  }
  shoot_light_rays();
  drop_ended();
}

void PathGroup::end_last_rays() {
  for (PathIntegrator* path : alive_)
    if (path->is_on_last_ray()) path->end_on_last_ray();
  drop_ended();
}

void PathGroup::shoot_light_rays() {
  for (const PathScratch::LightRay& one : scratch_.light_rays)
    if (!picture_.rays->occluded(one.ray)) paths_[one.path].gain(one.part);
  scratch_.light_rays.clear();
}

void PathGroup::drop_ended() {
  std::erase_if(alive_, [](const PathIntegrator* path) { return !path->lives_on(); });
}

void PathGroup::prefetch_hit_triangle(const RayHit& hit) const {
  if (has_corners(hit)) prefetch_triangle(*picture_.meshes[static_cast<std::size_t>(hit.mesh)], hit);
}

void PathGroup::prefetch_hit_corners() const {
  for (std::size_t k = 0; k < alive_.size(); ++k)
    if (has_corners(hits_[k]))
      prefetch_corners(*picture_.meshes[static_cast<std::size_t>(hits_[k].mesh)], hits_[k], alive_[k]->ray());
}

}  // namespace softreel
