#include "tests/benchmark/recorded_rays.h"

#include <atomic>

namespace softreel {

bool RecordingScene::intersect(const Ray& ray, RayHit& hit) const {
  recorded_.push_back({ray, false});
  return rays_->intersect(ray, hit);
}

bool RecordingScene::occluded(const Ray& ray) const {
  recorded_.push_back({ray, true});
  return rays_->occluded(ray);
}

std::int64_t RecordingScene::shoot_again(const Threads& threads) const {
  constexpr std::int64_t kChunk = 4096;  // about a tile of the picture
  std::atomic<std::int64_t> hits = 0;
  threads.for_chunks(static_cast<std::int64_t>(recorded_.size()), kChunk, [&](std::int64_t begin, std::int64_t end) {
    std::int64_t found = 0;
    for (std::int64_t k = begin; k < end; ++k) {
      const Recorded& one = recorded_[static_cast<std::size_t>(k)];
      RayHit hit;
      if (one.shadow ? rays_->occluded(one.ray) : rays_->intersect(one.ray, hit)) ++found;
    }
    hits += found;
  });
  return hits;
}

}  // namespace softreel
