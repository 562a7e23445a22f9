/// Daylight: the radiance of a clear to hazy sky, and the sun that goes with it.
///
/// Preetham, Shirley and Smits, A Practical Analytic Model for Daylight, 1999: Perez' distribution with their fits of
/// luminance (kcd/m^2) and chromaticity, and the attenuation of the sun by air, haze and ozone (their appendix 1,
/// here at one wavelength a colour; the gases and the water vapour, which take little of the visible light, are left
/// out). One unit of radiance is 10 kcd/m^2, one of irradiance 10 klx: a blue sky is about 0.5, the sun about 10.
#pragma once

#include <array>
#include <memory>

#include "render/scene/light.h"

namespace softreel {

/// Sun and haze. Angles in rad.
struct Daylight {
  float elevation = 0.8f;      ///< of the sun above the horizon, 0 to pi/2
  float azimuth = 0.6f;        ///< about the vertical; 0: the sun is in front, over +z, pi/2: over +x
  float turbidity = 3;         ///< 2 to 10: 2 very clear, 3 clear, 6 hazy
  float ground_albedo = 0.2f;  ///< of what is below the horizon

  friend bool operator==(const Daylight&, const Daylight&) = default;
};

class SkyModel {
 public:
  /// Throws input_error outside the ranges that the model was fitted to.
  explicit SkyModel(const Daylight& day);

  /// From a unit direction, without the sun's disk. Below the horizon: even ground in that light.
  Vec3f radiance(const Vec3f& direction) const;
  const Vec3f& towards_sun() const { return towards_sun_; }
  /// On a surface that faces the sun.
  const Vec3f& sun_irradiance() const { return sun_irradiance_; }
  /// Luminance straight up, kcd/m^2: the paper's fit.
  double zenith_luminance() const { return zenith_[0]; }

 private:
  /// Of luminance Y and chromaticity x, y.
  struct Perez {
    double a, b, c, d, e;
    double at(double cos_zenith, double angle_to_sun) const;
  };
  Vec3f above(const Vec3f& direction) const;

  std::array<Perez, 3> perez_;
  std::array<double, 3> zenith_, scale_;  ///< scale_: zenith values over Perez' function there
  Vec3f towards_sun_, sun_irradiance_;
  Vec3f ground_ = Vec3f::Zero();  ///< radiance
};

/// The sky as surroundings of that many pixels, twice as wide as high.
std::shared_ptr<const EnvironmentImage> sky_image(const SkyModel& sky, int height = 256);

}  // namespace softreel
