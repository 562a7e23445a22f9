#include "render/scene/sky_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/error.h"
#include "render/scene/environment_radiance.h"

namespace softreel {

namespace {

using std::numbers::pi;

/// Our unit of radiance, kcd/m^2.
constexpr double kUnit = 10;

/// Illuminance of the sun outside the air, klx, and its chromaticity.
constexpr double kSunKilolux = 133;
constexpr double kSunX = 0.3233, kSunY = 0.3326;

/// Luminance and chromaticity to linear Rec. 709 colours; what lies outside of their gamut goes to its edge.
Vec3f to_rgb(double luminance, double x, double y) {
  const double X = x / y * luminance, Z = (1 - x - y) / y * luminance;
  const Vec3 rgb(3.2404542 * X - 1.5371385 * luminance - 0.4985314 * Z,
                 -0.9692660 * X + 1.8760108 * luminance + 0.0415560 * Z,
                 0.0556434 * X - 0.2040259 * luminance + 1.0572252 * Z);
  return rgb.cwiseMax(0.0).cast<float>();
}

/// The paper's cubic in the sun's zenith angle and square in turbidity, for x and y straight up.
double zenith_chromaticity(const std::array<std::array<double, 4>, 3>& fit, double turbidity, double angle) {
  double sum = 0;
  double power = turbidity * turbidity;
  for (const auto& row : fit) {
    sum += power * (((row[0] * angle + row[1]) * angle + row[2]) * angle + row[3]);
    power /= turbidity;
  }
  return sum;
}

/// Share of the sun's light that reaches the ground, per colour.
Vec3 transmittance(double turbidity, double zenith_angle) {
  // Wavelengths in micrometres near the middles of red, green, blue, and ozone's absorption there, 1/cm.
  constexpr std::array<double, 3> kWavelength{0.61, 0.55, 0.465}, kOzone{0.120, 0.085, 0.010};
  constexpr double kOzoneLayer = 0.35;  // cm
  const double degrees = zenith_angle * 180 / pi;
  const double mass = 1 / (std::cos(zenith_angle) + 0.15 * std::pow(93.885 - degrees, -1.253));
  const double haze = 0.04608 * turbidity - 0.04586;  // Angstrom's coefficient
  Vec3 share;
  for (std::size_t c = 0; c < 3; ++c) {
    const double rayleigh = 0.008735 * std::pow(kWavelength[c], -4.08);
    const double aerosol = haze * std::pow(kWavelength[c], -1.3);
    share[static_cast<Eigen::Index>(c)] = std::exp(-mass * (rayleigh + aerosol + kOzone[c] * kOzoneLayer));
  }
  return share;
}

}  // namespace

double SkyModel::Perez::at(double cos_zenith, double angle_to_sun) const {
  const double cosine = std::cos(angle_to_sun);
  return (1 + a * std::exp(b / std::max(cos_zenith, 1e-3))) *
         (1 + c * std::exp(d * angle_to_sun) + e * cosine * cosine);
}

SkyModel::SkyModel(const Daylight& day) {
  const double t = static_cast<double>(day.turbidity), elevation = static_cast<double>(day.elevation);
  if (!(t >= 2 && t <= 10) || !(elevation >= 0 && elevation <= 0.5 * pi + 1e-6))
    throw input_error(
        fmt::format("A sky of turbidity {} with the sun {} degrees above the horizon is outside of the model.\n"
                    "  Accepted: 2 to 10; 0 to 90 degrees. Correct the sky, or use an environment image.",
                    t, elevation * 180 / pi));
  perez_ = {
      Perez{0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771, -0.0670 * t + 0.3703},
      Perez{-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
            -0.0033 * t + 0.0452},
      Perez{-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
            -0.0109 * t + 0.0529}};
  const double sun_angle = std::clamp(0.5 * pi - elevation, 0.0, 0.5 * pi);
  const double chi = (4.0 / 9 - t / 120) * (pi - 2 * sun_angle);
  zenith_[0] = (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
  zenith_[1] = zenith_chromaticity({{{0.00166, -0.00375, 0.00209, 0},
                                     {-0.02903, 0.06377, -0.03202, 0.00394},
                                     {0.11693, -0.21196, 0.06052, 0.25886}}},
                                   t, sun_angle);
  zenith_[2] = zenith_chromaticity({{{0.00275, -0.00610, 0.00317, 0},
                                     {-0.04214, 0.08970, -0.04153, 0.00516},
                                     {0.15346, -0.26756, 0.06670, 0.26688}}},
                                   t, sun_angle);
  for (std::size_t k = 0; k < 3; ++k) scale_[k] = zenith_[k] / perez_[k].at(1, sun_angle);
  const double azimuth = static_cast<double>(day.azimuth);
  towards_sun_ =
      Vec3(std::sin(sun_angle) * std::sin(azimuth), std::cos(sun_angle), std::sin(sun_angle) * std::cos(azimuth))
          .cast<float>();
  const Vec3f sun = to_rgb(kSunKilolux / kUnit, kSunX, kSunY);
  sun_irradiance_ = sun.cwiseProduct(transmittance(t, sun_angle).cast<float>());

  Vec3 irradiance = (sun_irradiance_ * std::max(0.0f, towards_sun_.y())).cast<double>();
  constexpr int kRows = 32, kColumns = 64;  // of equal shares of the cosine-weighted hemisphere
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const double sine2 = (row + 0.5) / kRows, turn = 2 * pi * (column + 0.5) / kColumns;
      const Vec3 direction(std::sqrt(sine2) * std::sin(turn), std::sqrt(1 - sine2), std::sqrt(sine2) * std::cos(turn));
      irradiance += above(direction.cast<float>()).cast<double>() * (pi / (kRows * kColumns));
    }
  ground_ = (static_cast<double>(day.ground_albedo) / pi * irradiance).cast<float>();
}

Vec3f SkyModel::above(const Vec3f& direction) const {
  const double cosine = static_cast<double>(direction.dot(towards_sun_));
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)), up = static_cast<double>(direction.y());
  std::array<double, 3> value{};
  for (std::size_t k = 0; k < 3; ++k) value[k] = scale_[k] * perez_[k].at(up, angle);
  return to_rgb(std::max(0.0, value[0]) / kUnit, value[1], value[2]);
}

Vec3f SkyModel::radiance(const Vec3f& direction) const {
  return direction.y() < 0 ? ground_ : above(direction);
}

std::shared_ptr<const EnvironmentImage> sky_image(const SkyModel& sky, int height) {
  auto image = std::make_shared<EnvironmentImage>();
  image->height = height;
  image->width = 2 * height;
  image->pixels.reserve(static_cast<std::size_t>(image->width) * static_cast<std::size_t>(height));
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < image->width; ++column) {
      const Vec2f at((static_cast<float>(column) + 0.5f) / static_cast<float>(image->width),
                     (static_cast<float>(row) + 0.5f) / static_cast<float>(height));
      image->pixels.push_back(sky.radiance(environment_direction(at, 0)));
    }
  return image;
}

}  // namespace softreel
