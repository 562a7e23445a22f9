/// The rays of a picture, to be shot again with nothing else around them.
#pragma once

#include <memory>
#include <vector>

#include "core/base/parallel.h"
#include "render/pathtrace/rays/ray_scene.h"

namespace softreel {

/// Passes all calls on, packets one ray at a time, and keeps the rays in their order. One thread only.
class RecordingScene : public RayScene {
 public:
  explicit RecordingScene(std::unique_ptr<RayScene> rays) : rays_(std::move(rays)) {}

  void build(const std::vector<const MotionMesh*>& meshes, double paths) override { rays_->build(meshes, paths); }
  bool intersect(const Ray& ray, RayHit& hit) const override;
  /// Of walks inside bodies, which the standard picture has not: passed on, not recorded.
  bool intersect_body(Index mesh, const Ray& ray, RayHit& hit, bool& front) const override {
    return rays_->intersect_body(mesh, ray, hit, front);
  }
  bool occluded(const Ray& ray) const override;

  std::size_t count() const { return recorded_.size(); }
  /// Shoots all of them, in their order; returns how many hit something.
  std::int64_t shoot_again(const Threads& threads) const;

 private:
  struct Recorded {
    Ray ray;
    bool shadow;
  };
  std::unique_ptr<RayScene> rays_;
  mutable std::vector<Recorded> recorded_;
};

}  // namespace softreel
