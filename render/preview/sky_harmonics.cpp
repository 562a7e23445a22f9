#include "render/preview/sky_harmonics.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace softreel {
namespace {

using Functions = std::array<double, kSkyHarmonics>;
constexpr double kTurn = 2 * std::numbers::pi;  ///< rad

Functions functions_at(const Vec3& d) {
  const double x = d.x(), y = d.y(), z = d.z();
  return {1, x, y, z, x * y, y * z, x * z, 3 * y * y - 1, x * x - z * z};
}

/// Share of a function that is left when the cosine lobe of a matt surface has blurred it, over the integral of its
/// square over all directions: bands 0, 1 and 2 keep 1, 2/3 and 1/4.
constexpr double kLinear = 2.0 / 3 * 3 / (2 * kTurn), kMixed = 0.25 * 15 / (2 * kTurn);
constexpr Functions kWeights{
    1 / (2 * kTurn),        kLinear, kLinear, kLinear, kMixed, kMixed, kMixed, 0.25 * 5 / (8 * kTurn),
    0.25 * 15 / (8 * kTurn)};

/// Sums over a row of 1, sin a, cos a, sin 2a and cos 2a times the radiance, a: azimuth.
using RowSums = std::array<Vec3, 5>;

RowSums row_sums(const Vec3f* row, const std::vector<double>& sines, const std::vector<double>& cosines) {
  RowSums sums;
  sums.fill(Vec3::Zero());
  for (std::size_t c = 0; c < sines.size(); ++c) {
    const Vec3 radiance = row[c].cast<double>();
    const double s = sines[c], k = cosines[c];
    sums[0] += radiance;
    sums[1] += s * radiance;
    sums[2] += k * radiance;
    sums[3] += 2 * s * k * radiance;
    sums[4] += (k * k - s * s) * radiance;
  }
  return sums;
}

}  // namespace

SkyHarmonics sky_harmonics(const EnvironmentImage& image) {
  const auto columns = static_cast<std::size_t>(image.width), rows = static_cast<std::size_t>(image.height);
  std::vector<double> sines(columns), cosines(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const double azimuth = ((static_cast<double>(c) + 0.5) / image.width - 0.5) * kTurn;
    sines[c] = std::sin(azimuth);
    cosines[c] = std::cos(azimuth);
  }
  std::array<Vec3, kSkyHarmonics> sums;
  sums.fill(Vec3::Zero());
  for (std::size_t r = 0; r < rows; ++r) {
    const RowSums m = row_sums(&image.pixels[r * columns], sines, cosines);
    const double from = 0.5 * kTurn * static_cast<double>(r) / image.height, to = from + 0.5 * kTurn / image.height;
    const double solid_angle = (std::cos(from) - std::cos(to)) * kTurn / image.width;
    const double ring = std::sin(0.5 * (from + to)), y = std::cos(0.5 * (from + to));
    // x = ring sin a, z = -ring cos a, as environment_direction.
    const std::array<Vec3, kSkyHarmonics> of_row{m[0],
                                                 ring * m[1],
                                                 y * m[0],
                                                 -ring * m[2],
                                                 ring * y * m[1],
                                                 -ring * y * m[2],
                                                 -0.5 * ring * ring * m[3],
                                                 (3 * y * y - 1) * m[0],
                                                 -ring * ring * m[4]};
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += solid_angle * of_row[k];
  }
  SkyHarmonics harmonics;
  for (std::size_t k = 0; k < sums.size(); ++k) harmonics[k] = (kWeights[k] * sums[k]).cast<float>();
  return harmonics;
}

Vec3f sky_light(const SkyHarmonics& harmonics, const Vec3f& normal) {
  const Functions functions = functions_at(normal.cast<double>());
  Vec3f sum = Vec3f::Zero();
  for (std::size_t k = 0; k < functions.size(); ++k) sum += static_cast<float>(functions[k]) * harmonics[k];
  return sum;
}

}  // namespace softreel
