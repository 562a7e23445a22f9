#include "render/pathtrace/pixel_sampling.h"

namespace softreel {

void PixelSampling::take(SampledPixel& pixel, int up_to) {
  const Sampler sampler(hash_, pixel.x, pixel.y);
  for (int sample = pixel.sums->samples; sample < up_to; ++sample) {
    const auto s = static_cast<std::uint32_t>(sample);
    pixels_[batch_.paths().size()] = &pixel;
    batch_.add(sampler, s, rays_.ray(pixel.x, pixel.y, sampler.numbers(s, 0)));
    if (batch_.is_full()) finish();
  }
}

void PixelSampling::finish() {
  batch_.trace();
  for (std::size_t k = 0; k < batch_.paths().size(); ++k) {
    const PathIntegrator& path = batch_.paths()[k];
    SampledPixel& pixel = *pixels_[k];
    if (pixel.sums->samples % kBatch == 0) pixel.before = *pixel.sums;
    pixel.sums->add(path.radiance(), path.first_hit());
    if (pixel.gathered != nullptr) pixel.gathered->add(path.camera_ray(), path.first_hit());
    if (pixel.sums->samples % kBatch == 0) pixel.sums->close_batch(pixel.before);
  }
  batch_.clear();
}

}  // namespace softreel
