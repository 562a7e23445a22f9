/// Directional albedos of surfaces, integrated once and looked up by the cosine of the direction.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

#include "core/base/types.h"

namespace softreel {

/// Two numbers a cosine, such as the directional albedos of a GGX surface of one roughness.
class AlbedoTable {
 public:
  /// Share of light that layers above let through, by the cosine of its direction; empty: all.
  using Passed = std::function<float(float)>;

  /// Reflectance F0 at normal incidence gives F0 * x + y. Under layers that let `passed` through, the reflection counts
  /// min(passed(o), passed(i)).
  static AlbedoTable of_reflection(float alpha, const Passed& passed = {});
  /// Shares of light that glass reflects and lets through; eta: index of the far side over that of the near side.
  static AlbedoTable of_glass(float alpha, float eta);
  /// Of any function of the cosine.
  static AlbedoTable of(const std::function<Vec2f(float)>& albedo_at);

  /// At the cosine mu in [0, 1].
  Vec2f at(float cosine) const {
    const float s = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * kIntervals;
    const int k = std::min(static_cast<int>(s), kIntervals - 1);
    const float t = s - static_cast<float>(k);
    const auto i = static_cast<std::size_t>(k);
    return (1 - t) * knots_[i] + t * knots_[i + 1];
  }
  /// Mean, weighted by 2 mu.
  Vec2f mean() const { return mean_; }
  /// share: 0 gives a, bit for bit.
  static AlbedoTable between(const AlbedoTable& a, const AlbedoTable& b, float share);

 private:
  static constexpr int kIntervals = 32;
  std::array<Vec2f, kIntervals + 1> knots_{};  ///< at mu = (k / kIntervals)^2: dense where E bends, at grazing angles
  Vec2f mean_ = Vec2f::Zero();
};

}  // namespace softreel
