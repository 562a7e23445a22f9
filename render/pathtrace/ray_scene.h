/// Triangles in trees that rays are shot at; the only place that knows Embree.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/base/parallel.h"
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

/// Trees over the meshes of one frame. Queries are thread-safe.
class RayScene {
 public:
  /// Throws input_error if built without Embree, work_error if Embree cannot start.
  /// threads: how many will call it and build its trees.
  explicit RayScene(int threads);
  ~RayScene();

  /// Replaces everything by trees over `meshes`, whose positions are copied. The trees depend on the meshes only: not
  /// on earlier frames, nor on the number of threads. Throws work_error where memory is short.
  void build(const Threads& threads, const std::vector<const MotionMesh*>& meshes);

  /// coherent: neighbouring calls have similar rays (a hint for speed only).
  bool intersect(const Ray& ray, RayHit& hit, bool coherent) const;
  /// Whether anything is on the ray.
  bool occluded(const Ray& ray, bool coherent) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softreel
