#include "render/pathtrace/lights/environment_light.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <span>

#include "render/pathtrace/rays/sampling.h"
#include "render/scene/environment_radiance.h"

namespace softreel {

namespace {

/// Cumulated shares of `weights`, n + 1 numbers from 0 to 1; even shares if all weights are 0. Returns the sum.
double cumulate(std::span<const double> weights, std::span<float> shares) {
  double sum = 0;
  for (const double w : weights) sum += w;
  double before = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    shares[k] =
        static_cast<float>(sum > 0 ? before / sum : static_cast<double>(k) / static_cast<double>(weights.size()));
    before += weights[k];
  }
  shares[weights.size()] = 1;
  return sum;
}

/// Interval that u falls in, and u's place in it.
int find_interval(std::span<const float> shares, float u, float& place) {
  const auto after = std::upper_bound(shares.begin() + 1, shares.end() - 1, u);
  const auto k = static_cast<std::size_t>(after - shares.begin()) - 1;
  const float width = shares[k + 1] - shares[k];
  place = width > 0 ? std::clamp((u - shares[k]) / width, 0.0f, 0x1.fffffep-1f) : 0.5f;
  return static_cast<int>(k);
}

/// Mean luminance over one texel of the bilinear interpolation between texel centres: of the texel and its neighbours
/// in the shares 1, 6, 1 of 8 each way. 0 only where the texel is black.
double texel_mean(const EnvironmentImage& image, int column, int row) {
  constexpr double kShares[] = {0.125, 0.75, 0.125};
  double sum = 0;
  for (int dr = -1; dr <= 1; ++dr)
    for (int dc = -1; dc <= 1; ++dc) {
      const auto r = static_cast<std::size_t>(std::clamp(row + dr, 0, image.height - 1));
      const auto c = static_cast<std::size_t>((column + dc + image.width) % image.width);
      const Vec3f& pixel = image.pixels[r * static_cast<std::size_t>(image.width) + c];
      sum += kShares[dr + 1] * kShares[dc + 1] * static_cast<double>(luminance(pixel));
    }
  return sum;
}

}  // namespace

EnvironmentLight::EnvironmentLight(const Environment& environment) : environment_(environment) {
  if (!environment.image || environment.strength <= 0) return;
  const EnvironmentImage& image = *environment.image;
  width_ = image.width;
  height_ = image.height;
  const auto w = static_cast<std::size_t>(width_), h = static_cast<std::size_t>(height_);
  rows_.resize(h + 1);
  columns_.resize(h * (w + 1));
  std::vector<double> row_weights(h), weights(w);
  for (std::size_t row = 0; row < h; ++row) {
    const double sine = std::sin(std::numbers::pi * (static_cast<double>(row) + 0.5) / static_cast<double>(h));
    for (std::size_t c = 0; c < w; ++c)
      weights[c] = sine * texel_mean(image, static_cast<int>(c), static_cast<int>(row));
    row_weights[row] = cumulate(weights, std::span(columns_).subspan(row * (w + 1), w + 1));
  }
  const double sum = cumulate(row_weights, rows_);
  // The integral over all directions, a quarter of which arrives at an average surface.
  const double texel = 2 * std::numbers::pi * std::numbers::pi / (static_cast<double>(w) * static_cast<double>(h));
  importance_ = static_cast<float>(0.25 * environment.strength * sum * texel);
  if (!(sum > 0)) rows_.clear();
}

float EnvironmentLight::texel_pdf(int column, int row) const {
  const auto c = static_cast<std::size_t>(column), r = static_cast<std::size_t>(row);
  const float* shares = &columns_[r * (static_cast<std::size_t>(width_) + 1)];
  return (rows_[r + 1] - rows_[r]) * (shares[c + 1] - shares[c]) * static_cast<float>(width_) *
         static_cast<float>(height_);
}

LightSample EnvironmentLight::sample(const Vec2f& u) const {
  float s = 0, t = 0;
  const int row = find_interval(rows_, u.y(), t);
  const auto w = static_cast<std::size_t>(width_);
  const int column =
      find_interval(std::span(columns_).subspan(static_cast<std::size_t>(row) * (w + 1), w + 1), u.x(), s);
  const Vec2f at((static_cast<float>(column) + s) / static_cast<float>(width_),
                 (static_cast<float>(row) + t) / static_cast<float>(height_));
  LightSample sample;
  sample.direction = environment_direction(at, environment_.rotation);
  sample.distance = std::numeric_limits<float>::infinity();
  sample.radiance = environment_radiance(environment_, sample.direction);
  sample.pdf = texel_pdf(column, row) / (2 * kPi * kPi * std::max(1e-6f, std::sin(kPi * at.y())));
  return sample;
}

float EnvironmentLight::pdf(const Vec3f& direction) const {
  const Vec2f at = environment_coordinates(direction, environment_.rotation);
  const int column = std::min(static_cast<int>(at.x() * static_cast<float>(width_)), width_ - 1);
  const int row = std::min(static_cast<int>(at.y() * static_cast<float>(height_)), height_ - 1);
  return texel_pdf(column, row) / (2 * kPi * kPi * std::max(1e-6f, std::sin(kPi * at.y())));
}

Vec3f EnvironmentLight::radiance(const Vec3f& direction) const {
  return environment_radiance(environment_, direction);
}

}  // namespace softreel
