/// Measurements of scattering functions, shared by the tests of render and of the material library.
#pragma once

#include <cmath>
#include <random>

#include "render/pathtrace/materials/bsdf.h"
#include "render/pathtrace/rays/sampler.h"
#include "render/pathtrace/rays/sampling.h"

namespace softreel {

inline Vec3f direction(float polar, float azimuth) {
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

/// Integral over all directions of f(direction), by midpoints in cosine and azimuth.
template <typename F>
Vec3f over_sphere(const F& f) {
  constexpr int kRows = 400, kColumns = 200;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      const float z = -1 + 2 * (static_cast<float>(r) + 0.5f) / kRows;
      const Vec3f i = direction(std::acos(z), 2 * kPi * (static_cast<float>(c) + 0.5f) / kColumns);
      sum += f(i).template cast<double>();
    }
  return (sum * (4 * M_PI / (kRows * kColumns))).template cast<float>();
}

/// Share of a beam that enters a body which lets all of it out again: that of `sample`'s subsurface lobe.
inline float mean_leaving(const Bsdf& bsdf) {
  constexpr int kSteps = 2000;
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    const float z = (static_cast<float>(k) + 0.5f) / kSteps;
    sum += static_cast<double>(bsdf.evaluate_leaving(direction(std::acos(z), 0.3f)).value.x());
  }
  return static_cast<float>(sum * 2 * M_PI / kSteps);
}

/// Albedo seen from `o`, by sampling; bodies let out all that enters, as white ones do.
inline Vec3f sampled_albedo(const Bsdf& bsdf, const Vec3f& o, bool inside, std::uint32_t samples = 4096) {
  const Sampler sampler(11, 12, 13);
  const float leaving = mean_leaving(bsdf);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::uint32_t s = 0; s < samples; ++s) {
    const SampleBlock u = sampler.numbers(s, 0);
    BsdfSample sample;
    if (!bsdf.sample(o, u[2], Vec2f(u[0], u[1]), inside, sample)) continue;
    sum += (sample.subsurface ? Vec3f(leaving * sample.weight) : sample.weight).cast<double>();
  }
  return (sum / samples).cast<float>();
}

/// What sample() draws and what evaluate() says, by moments of the direction: their largest difference in standard
/// deviations of its estimate, over the functions 1, x, y, z, z^2, x z and x^2 - y^2 of directions that are not
/// mirrors'. evaluate() is integrated by samples of `proposal`, a rougher twin, and of the whole sphere, half of each.
inline double moment_mismatch(const Bsdf& bsdf, const Bsdf& proposal, const Vec3f& o, bool inside, int samples) {
  using Moments = Eigen::Array<double, 7, 1>;
  const auto moments_of = [](const Vec3f& v) {
    const double x = static_cast<double>(v.x()), y = static_cast<double>(v.y()), z = static_cast<double>(v.z());
    return Moments((Moments() << 1, x, y, z, z * z, x * z, x * x - y * y).finished());
  };
  std::mt19937 engine(7);
  const auto uniform = [&engine] { return static_cast<float>(engine() >> 8) * 0x1p-24f; };
  Moments drawn = Moments::Zero(), drawn2 = Moments::Zero(), said = Moments::Zero(), said2 = Moments::Zero();
  const auto add = [](Moments& sum, Moments& squares, const Moments& m) {
    sum += m;
    squares += m.square();
  };
  for (int k = 0; k < samples; ++k) {
    BsdfSample sample;
    const float lobe = uniform(), a = uniform(), b = uniform();
    if (bsdf.sample(o, lobe, Vec2f(a, b), inside, sample) && !sample.mirror && !sample.subsurface)
      add(drawn, drawn2, moments_of(sample.direction));
    Vec3f i;
    if (uniform() < 0.5f) {
      const float c = uniform(), d = uniform(), e = uniform();
      if (!proposal.sample(o, c, Vec2f(d, e), inside, sample) || sample.mirror || sample.subsurface) continue;
      i = sample.direction;
    } else {
      const float c = uniform(), d = uniform();
      i = direction(std::acos(1 - 2 * c), 2 * kPi * d);
    }
    const double density = 0.5 * static_cast<double>(proposal.evaluate(o, i, inside).pdf) + 0.5 / (4 * M_PI);
    add(said, said2, moments_of(i) * (static_cast<double>(bsdf.evaluate(o, i, inside).pdf) / density));
  }
  const double n = samples;
  const Moments variance = (drawn2 / n - (drawn / n).square() + said2 / n - (said / n).square()) / n;
  return ((drawn - said).abs() / n / (variance.sqrt() + 1e-5)).maxCoeff();
}

}  // namespace softreel
