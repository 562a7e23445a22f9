/// Paths that are traced side by side, event by event.
///
/// What the camera sees is found by packets of rays, which Embree traces in a third of the time of single ones; those
/// of lights and later events are too different for that. And while one path's ray is shot or scatters, what the others
/// will read of the meshes comes from memory: paths traced one after the other from their first hits took 5 to 8 %
/// longer.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/check.h"
#include "render/pathtrace/path_integrator.h"

namespace softreel {

/// Most paths of a group. 8 to 64 of them took the same time.
inline constexpr std::size_t kGroupPaths = 32;
static_assert(kGroupPaths >= kRayPacket);

class PathGroup {
 public:
  explicit PathGroup(const Picture& picture) : picture_(picture) { paths_.reserve(kGroupPaths); }

  /// Paths that may still be added.
  std::size_t room() const { return kGroupPaths - paths_.size(); }
  /// packet: of the camera ray; consecutive paths of the same number, at most kRayPacket, are shot together. Which of
  /// several triangles at equal distances a ray hits may depend on the others of its packet, and nothing else does.
  void add(const Sampler& sampler, std::uint32_t sample, const Ray& camera_ray, int packet) {
    CHECK(room() > 0u);
    packets_[paths_.size()] = packet;
    paths_.emplace_back(picture_, sampler, sample, camera_ray, paths_.size());
  }
  /// All of them to their ends.
  void trace();
  /// In the order they were added in.
  const std::vector<PathIntegrator>& paths() const { return paths_; }
  void clear() { paths_.clear(); }

 private:
  void shoot_camera_rays();
  void shoot_rays();
  void shoot_ray(std::size_t k);  ///< of the k-th one alive
  /// What the alive paths' rays hit, they go on from.
  void scatter();
  void end_last_rays();
  void shoot_light_rays();
  void drop_ended();
  /// What the paths will read of the meshes is asked for in turn, as triangles name their corners.
  /// Whether surface_point will read the mesh.
  bool has_corners(const RayHit& hit) const { return hit.mesh >= 0 && !picture_.rays->is_ground(hit.mesh); }
  void prefetch_hit_triangle(const RayHit& hit) const;
  void prefetch_hit_corners() const;

  const Picture& picture_;
  std::vector<PathIntegrator> paths_;
  std::array<int, kGroupPaths> packets_{};  ///< per path
  std::vector<PathIntegrator*> alive_;
  std::array<RayHit, kGroupPaths> hits_;  ///< of those alive; .mesh is -1 where there is none
  PathScratch scratch_;
};

}  // namespace softreel
