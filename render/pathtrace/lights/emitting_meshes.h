/// Bodies that shine: their triangles as lights.
#pragma once

#include <vector>

#include "render/pathtrace/lights/light_tree.h"
#include "render/pathtrace/lights/rectangle_light.h"
#include "render/pathtrace/rays/ray_scene.h"

namespace softreel {

/// The triangles of all meshes whose appearance has an emission; each emits from its front.
class EmittingMeshes {
 public:
  /// Keeps pointers to the emitting meshes, which are known by their place in the list.
  explicit EmittingMeshes(const std::vector<MotionMesh>& meshes);

  bool empty() const { return tree_.empty(); }
  /// A point of a triangle, even over its area as it is at `time` of the shutter; sample.pdf by solid angle. False if
  /// the triangle shows its back, or none can be seen.
  bool sample(const TreeReceiver& receiver, float time, float choice, const Vec2f& u, LightSample& sample) const;
  /// Density of sample() for the triangle that `ray`, which left the receiver, hit on its front; 0 if its mesh does
  /// not emit.
  float pdf(const TreeReceiver& receiver, const Ray& ray, const RayHit& hit) const;
  float importance(const TreeReceiver& receiver) const { return tree_.importance(receiver); }

 private:
  struct Emitter {
    Index mesh, triangle;
  };
  std::vector<const MotionMesh*> meshes_;
  std::vector<Index> first_;  ///< per mesh, its first emitter; -1: it does not emit
  std::vector<Emitter> emitters_;
  LightTree tree_;
};

}  // namespace softreel
