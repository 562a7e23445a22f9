/// Paths that are traced side by side, event by event.
///
/// What the camera sees is found by packets of rays, which Embree traces in a third of the time of single ones; those
/// of lights and later events are too different for that. And while one path's ray is shot or scatters, what the others
/// will read of the meshes comes from memory: paths traced one after the other from their first hits take 5 to 8 %
/// longer.
#pragma once

#include "render/pathtrace/path_integrator.h"

namespace softreel {

/// Paths of a batch: so many that what one kind of work needs stays in the cache while it is done for all.
inline constexpr std::size_t kBatchPaths = 32;

/// At most kBatchPaths paths. A path gets the same light in any company.
class PathBatch {
 public:
  explicit PathBatch(const Picture& picture) : picture_(picture) { paths_.reserve(kBatchPaths); }

  bool is_full() const { return paths_.size() == kBatchPaths; }
  void add(const Sampler& sampler, std::uint32_t sample, const Ray& camera_ray) {
    paths_.emplace_back(picture_, sampler, sample, camera_ray, paths_.size());
  }
  /// All of them to their ends.
  void trace();
  /// In the order they were added in.
  const std::vector<PathIntegrator>& paths() const { return paths_; }
  void clear() { paths_.clear(); }

 private:
  /// Ends paths on their last rays, and finds what the others' rays hit.
  void shoot_rays(bool together);
  void shoot_light_rays();
  /// What the paths will read of the meshes is asked for in turn, as triangles name their corners.
  void prefetch_hit_triangle(const RayHit& hit) const;
  void prefetch_hit_corners() const;

  const Picture& picture_;
  std::vector<PathIntegrator> paths_;
  std::vector<PathIntegrator*> alive_;
  std::array<RayHit, kBatchPaths> hits_;  ///< of those alive; .mesh is -1 where there is none
  PathScratch scratch_;
};

}  // namespace softreel
