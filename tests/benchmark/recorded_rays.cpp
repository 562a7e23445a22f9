#include "tests/benchmark/recorded_rays.h"

#include <atomic>

namespace softreel {

bool RecordingScene::intersect(const Ray& ray, RayHit& hit, bool coherent) const {
  recorded_.push_back({ray, false, coherent});
  return rays_->intersect(ray, hit, coherent);
}

bool RecordingScene::occluded(const Ray& ray, bool coherent) const {
  recorded_.push_back({ray, true, coherent});
  return rays_->occluded(ray, coherent);
}

std::int64_t RecordingScene::shoot_again(const Threads& threads) const {
  constexpr std::int64_t kChunk = 4096;  // about a tile of the picture
  std::atomic<std::int64_t> hits = 0;
  threads.for_chunks(static_cast<std::int64_t>(recorded_.size()), kChunk, [&](std::int64_t begin, std::int64_t end) {
    std::int64_t found = 0;
    for (std::int64_t k = begin; k < end; ++k) {
      const Recorded& one = recorded_[static_cast<std::size_t>(k)];
      RayHit hit;
      if (one.shadow ? rays_->occluded(one.ray, one.coherent) : rays_->intersect(one.ray, hit, one.coherent)) ++found;
    }
    hits += found;
  });
  return hits;
}

}  // namespace softreel
