/// Owen-scrambled Sobol points, keyed by pixel and picture.
///
/// Sobol's first two dimensions, padded: every pair of dimensions takes the same (0,2)-sequence in its own shuffled
/// order and with its own scrambling. Scrambling by hashing: Laine and Karras, Stratified Sampling for Stochastic
/// Transparency, 2011, and Burley, Practical Hash-based Owen Scrambling, 2020, with the constants of N. Vegdahl (2021).
#pragma once

#include <array>
#include <cstdint>

#include "core/base/types.h"

namespace softreel {

/// Random numbers of one scattering event, or of the camera: eight dimensions, each pair (0,1), (2,3)... well spread.
using SampleBlock = std::array<float, 8>;

/// Mixes all bits of x into all bits of the result (the finaliser of MurmurHash3, public domain).
inline std::uint32_t mix_bits(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x85ebca6bu;
  x ^= x >> 13;
  x *= 0xc2b2ae35u;
  return x ^ (x >> 16);
}

/// The points of one pixel.
class Sampler {
 public:
  /// picture: hash of what the picture shows; x, y: the pixel.
  Sampler(std::uint64_t picture, int x, int y);

  /// Block `block` of point `sample`; numbers in [0, 1). Pure.
  SampleBlock numbers(std::uint32_t sample, std::uint32_t block) const;

  /// The points 2 sample and 2 sample + 1 of a pair of dimensions, block `block`: for what is sampled twice a path.
  /// Over n samples they are as even as the first 2 n points of any pair. Pure.
  std::array<Vec2f, 2> two_points(std::uint32_t sample, std::uint32_t block) const;

 private:
  std::uint32_t key(std::uint32_t block) const;

  std::uint32_t seed_;
};

}  // namespace softreel
