#include "render/pathtrace/adaptive_sampling.h"

#include <algorithm>

namespace softreel {

namespace {

/// Light below this looks black whatever its noise: the slope of the screen's curve ends there.
constexpr double kBlack = 0.01;
constexpr int kReach = 2;  ///< pixels on either side that a decision takes in

/// Squared error of the shadow catcher's alpha over white. The shade is a ratio r of two sums; its variance is that of
/// the residuals shadowed - r unshadowed of the batches over the square of the sum below the line.
double squared_alpha_error(const PixelSums& pixel, int batches) {
  if (pixel.caught == 0 || !(pixel.unshadowed > 0)) return 0;
  const double r = pixel.shadowed / pixel.unshadowed;
  const auto& s = pixel.shadow_squares;
  const double residuals = std::max(0.0, s[0] - 2 * r * s[1] + r * r * s[2]);
  const double variance = residuals * batches / (batches - 1) / (pixel.unshadowed * pixel.unshadowed);
  const double share = static_cast<double>(pixel.caught) / pixel.samples;
  return share * share * variance / (4 * std::max(1 - pixel.alpha(), kBlack));
}

}  // namespace

double squared_screen_error(const PixelSums& pixel) {
  const int batches = pixel.samples / kBatch;
  if (batches < 2) return 0;
  const double n = static_cast<double>(batches) * kBatch;
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double total = pixel.values[c] * n / pixel.samples;  // without the odd samples of a last, cut batch
    const double spread = std::max(0.0, pixel.batch_squares[c] - total * total / batches) / (batches - 1);
    const double variance_of_mean = spread * batches / (n * n);
    sum += variance_of_mean / (4 * std::max(total / n, kBlack));
  }
  return sum / 3 + squared_alpha_error(pixel, batches);
}

std::vector<std::uint8_t> noisy_pixels(const std::vector<PixelSums>& pixels, int width, int height, double noise) {
  std::vector<double> squared(pixels.size());
  for (std::size_t k = 0; k < pixels.size(); ++k) squared[k] = squared_screen_error(pixels[k]);
  std::vector<std::uint8_t> noisy(pixels.size());
  const auto place = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      int count = 0;
      for (int v = std::max(0, y - kReach); v <= std::min(height - 1, y + kReach); ++v)
        for (int u = std::max(0, x - kReach); u <= std::min(width - 1, x + kReach); ++u, ++count)
          sum += squared[place(u, v)];
      noisy[place(x, y)] = sum > noise * noise * count ? 1 : 0;
    }
  return noisy;
}

int samples_after_pass(int samples, int step, int most) {
  const int steps = std::max(1, samples / 4 / step);
  return std::min(most, samples + steps * step);
}

}  // namespace softreel
