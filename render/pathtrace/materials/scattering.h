/// What a scattering function answers: values with densities, and samples; what is between two of them.
#pragma once

#include <cmath>

#include "core/base/types.h"

namespace softreel {

/// f cos_i and the density of sample() for the same pair.
struct BsdfValue {
  Vec3f value = Vec3f::Zero();
  float pdf = 0;
};

struct BsdfSample {
  Vec3f direction;          ///< local
  Vec3f weight;             ///< f cos_i / pdf
  float pdf = 0;            ///< by solid angle; 0 if `mirror` or `subsurface`
  bool wide = false;        ///< of a lobe so wide that no details show through it
  bool mirror = false;      ///< one of finitely many directions: no light sampling can find it
  bool subsurface = false;  ///< enters the body there, to be scattered inside (Bsdf::subsurface)
};

[[gnu::noinline]] inline Vec3f beers_law(const Vec3f& absorption, float distance) {
  return (-distance * absorption).array().exp().matrix();
}

/// What is left of light after `distance` m, by Beer's law; all of it where it comes from beyond everything, as nobody
/// is inside a body there. absorption: 1/m.
[[gnu::always_inline]] inline Vec3f transmittance(const Vec3f& absorption, float distance) {
  const bool clear = absorption.x() == 0 && absorption.y() == 0 && absorption.z() == 0;
  return clear || !std::isfinite(distance) ? Vec3f(Vec3f::Ones()) : beers_law(absorption, distance);
}

}  // namespace softreel
