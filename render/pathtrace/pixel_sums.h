/// What the paths of one pixel add up to, and how much their mean may still be off.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "render/pathtrace/path_integrator.h"

namespace softreel {

/// Samples of a batch: consecutive ones, so that each batch is spread as well as so few points can be.
inline constexpr int kBatch = 8;

/// Sums in double and in the order of the samples: the same bits however the samples are cut into passes.
struct PixelSums {
  std::array<double, 3> values{};         ///< radiance
  std::array<double, 3> batch_squares{};  ///< of the radiance of each whole batch
  /// Of each whole batch's light on the shadow catcher: shadowed squared, shadowed times unshadowed, unshadowed
  /// squared.
  std::array<double, 3> shadow_squares{};
  double coverage = 0;                  ///< samples that hit something to be seen (see ShadowCatcher)
  double unshadowed = 0, shadowed = 0;  ///< light on the shadow catcher without and with the bodies in its way
  int caught = 0;                       ///< samples that hit the shadow catcher
  int samples = 0;

  void add(const Vec3f& radiance, const FirstHit& hit) {
    for (std::size_t c = 0; c < 3; ++c) values[c] += static_cast<double>(radiance[static_cast<Eigen::Index>(c)]);
    coverage += static_cast<double>(hit.coverage);
    unshadowed += static_cast<double>(hit.unshadowed);
    shadowed += static_cast<double>(hit.shadowed);
    if (hit.caught) ++caught;
    ++samples;
  }

  /// Ends a whole batch, which began when the sums were `before`.
  void close_batch(const PixelSums& before) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double batch = values[c] - before.values[c];
      batch_squares[c] += batch * batch;
    }
    const double with = shadowed - before.shadowed, without = unshadowed - before.unshadowed;
    shadow_squares[0] += with * with;
    shadow_squares[1] += with * without;
    shadow_squares[2] += without * without;
  }

  /// Share of what is behind the pixel that it hides: bodies all of it, the shadow catcher what its shadow takes away.
  double alpha() const {
    const double shade = unshadowed > 0 ? std::max(0.0, 1 - shadowed / unshadowed) : 0.0;
    return samples > 0 ? (coverage + caught * shade) / samples : 0.0;
  }
};

}  // namespace softreel
