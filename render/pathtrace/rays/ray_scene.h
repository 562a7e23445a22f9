/// Triangles in trees that rays are shot at.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "render/scene/scene.h"

namespace softreel {

struct Ray {
  Vec3f origin;
  Vec3f direction;  ///< unit
  float max_distance = std::numeric_limits<float>::infinity();
  float time = 0;  ///< 0: shutter opens, 1: it closes
};

/// Nearest triangle on a ray. The hit is at (1-u-v) p0 + u p1 + v p2.
struct RayHit {
  float distance = 0;  ///< m
  float u = 0, v = 0;
  Index mesh = -1;
  Index triangle = -1;
};

/// Most rays that are shot together, as wide as Embree's vectors.
inline constexpr std::size_t kRayPacket = 8;

/// Trees over the meshes of one frame. Queries are thread-safe.
class RayScene {
 public:
  virtual ~RayScene() = default;

  /// Replaces everything by trees over `meshes`, whose positions are copied. Where no mesh moves while the shutter is
  /// open and one knows its rest_positions, trees of the shapes at rest are made once, kept, and fitted to the
  /// positions; a frame they would fit badly (tree_fit.h), and every other one, gets trees of its own. The trees depend
  /// on the meshes only: not on earlier frames, nor on the number of threads, which are those of the caller's arena
  /// (Threads::run). Throws work_error where memory is short.
  virtual void build(const std::vector<const MotionMesh*>& meshes, double paths) = 0;

  virtual bool intersect(const Ray& ray, RayHit& hit) const = 0;
  /// As intersect, but of one mesh, whose material scatters light inside (subsurface above 0). front: hit from outside.
  virtual bool intersect_body(Index mesh, const Ray& ray, RayHit& hit, bool& front) const = 0;
  /// Whether anything is on the ray.
  virtual bool occluded(const Ray& ray) const = 0;

  /// intersect of at most kRayPacket rays together, which is quicker where they are similar. hits: as many as rays;
  /// .mesh is -1 where nothing is hit. Of triangles at equal distances each ray hits one, but which of them may depend
  /// on the others.
  virtual void intersect_packet(std::span<const Ray> rays, std::span<RayHit> hits) const {
    for (std::size_t k = 0; k < rays.size(); ++k)
      if (!intersect(rays[k], hits[k])) hits[k].mesh = -1;
  }
};

/// threads: how many will call it and build its trees.
/// Throws input_error if built without Embree, work_error if Embree cannot be loaded or started.
std::unique_ptr<RayScene> make_ray_scene(int threads);

/// The entry of the part, which make_ray_scene calls.
extern "C" [[gnu::visibility("default")]] std::unique_ptr<RayScene> softreel_make_embree_scene(int threads);

}  // namespace softreel
