#include "render/pathtrace/sampler.h"

namespace softreel {

namespace {

// Loops over lanes are written so that the compiler turns each into a few vector instructions.
using Lanes = std::array<std::uint32_t, 8>;

std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(x);  // one shuffle for all lanes
}

/// Owen's scrambling of a number whose bits are reversed: every bit is flipped depending on the bits below it.
std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  return x ^ (x * 0x53a22864u);
}

/// Sobol's second dimension of `index`, bits reversed. Its matrix is Pascal's triangle modulo 2, where (k over j) is
/// odd if the bits of j are among those of k: each output bit is the parity of the input bits at supersets of its
/// position.
std::uint32_t sobol_second_reversed(std::uint32_t index) {
  index ^= (index & 0xaaaaaaaau) >> 1;
  index ^= (index & 0xccccccccu) >> 2;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xff00ff00u) >> 8;
  return index ^ (index >> 16);
}

}  // namespace

Sampler::Sampler(std::uint64_t picture, int x, int y) {
  const auto low = static_cast<std::uint32_t>(picture);
  const auto high = static_cast<std::uint32_t>(picture >> 32);
  seed_ = mix_bits(low ^ mix_bits(high ^ mix_bits(static_cast<std::uint32_t>(x) ^
                                                  mix_bits(static_cast<std::uint32_t>(y) + 0x9e3779b9u))));
}

SampleBlock Sampler::numbers(std::uint32_t sample, std::uint32_t block) const {
  constexpr std::uint32_t kGolden = 0x9e3779b9u;  // 2^32 over the golden ratio: spreads consecutive keys
  const std::uint32_t reversed_sample = reverse_bits(sample);
  const std::uint32_t key = seed_ + (block + 1) * 16 * kGolden;
  SampleBlock out;
  for (std::uint32_t lane = 0; lane < 8; ++lane) {
    const std::uint32_t order_seed = mix_bits(key + (lane / 2) * kGolden);
    const std::uint32_t value_seed = mix_bits(key + (lane + 8) * kGolden);
    const std::uint32_t index = reverse_bits(scramble_reversed(reversed_sample, order_seed));
    const std::uint32_t reversed = (lane & 1u) != 0 ? sobol_second_reversed(index) : index;
    const std::uint32_t value = reverse_bits(scramble_reversed(reversed, value_seed));
    out[lane] = static_cast<float>(static_cast<std::int32_t>(value >> 8)) * 0x1p-24f;
  }
  return out;
}

}  // namespace softreel
