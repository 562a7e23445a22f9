#include "render/pathtrace/pixel_sampling.h"

#include <algorithm>

namespace softreel {

void PixelSampling::take(SampledPixel& pixel, int up_to) {
  const Sampler sampler(hash_, pixel.x, pixel.y);
  constexpr int kPacket = static_cast<int>(kRayPacket);
  for (int begin = pixel.sums->samples, end = 0; begin < up_to; begin = end) {
    end = std::min(begin / kPacket * kPacket + kPacket, up_to);
    if (group_.room() < static_cast<std::size_t>(end - begin)) finish();
    ++packet_;
    for (int sample = begin; sample < end; ++sample) {
      const auto s = static_cast<std::uint32_t>(sample);
      pixels_[group_.paths().size()] = &pixel;
      group_.add(sampler, s, rays_.ray(pixel.x, pixel.y, sampler.numbers(s, 0)), packet_);
    }
  }
}

void PixelSampling::finish() {
  group_.trace();
  for (std::size_t k = 0; k < group_.paths().size(); ++k) {
    const PathIntegrator& path = group_.paths()[k];
    SampledPixel& pixel = *pixels_[k];
    if (pixel.sums->samples % kBatch == 0) pixel.before = *pixel.sums;
    pixel.sums->add(path.radiance(), path.first_hit());
    if (pixel.gathered != nullptr) pixel.gathered->add(path.camera_ray(), path.first_hit());
    if (pixel.sums->samples % kBatch == 0) pixel.sums->close_batch(pixel.before);
  }
  group_.clear();
}

}  // namespace softreel
