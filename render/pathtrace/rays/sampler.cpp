#include "render/pathtrace/rays/sampler.h"

namespace softreel {

namespace {

// What follows has no branches, so that the compiler turns a loop over coordinates into vector instructions.

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

constexpr std::uint32_t kGolden = 0x9e3779b9u;  // 2^32 over the golden ratio: spreads consecutive keys

/// First or second (1) coordinate of a point. The order's key is its pair's, the value's its own. Always inlined: else
/// the loops over it become no vector instructions, and take five times as many.
[[gnu::always_inline]] inline float coordinate(std::uint32_t reversed_sample, std::uint32_t order_key,
                                               std::uint32_t value_key, std::uint32_t second) {
  const std::uint32_t index = reverse_bits(scramble_reversed(reversed_sample, mix_bits(order_key)));
  const std::uint32_t reversed = second != 0 ? sobol_second_reversed(index) : index;
  const std::uint32_t value = reverse_bits(scramble_reversed(reversed, mix_bits(value_key)));
  return static_cast<float>(static_cast<std::int32_t>(value >> 8)) * 0x1p-24f;
}

}  // namespace

Sampler::Sampler(std::uint64_t picture, int x, int y) {
  const auto low = static_cast<std::uint32_t>(picture);
  const auto high = static_cast<std::uint32_t>(picture >> 32);
  seed_ = mix_bits(low ^ mix_bits(high ^ mix_bits(static_cast<std::uint32_t>(x) ^
                                                  mix_bits(static_cast<std::uint32_t>(y) + 0x9e3779b9u))));
}

std::uint32_t Sampler::key(std::uint32_t block) const {
  return seed_ + (block + 1) * 16 * kGolden;
}

SampleBlock Sampler::numbers(std::uint32_t sample, std::uint32_t block) const {
  const std::uint32_t reversed_sample = reverse_bits(sample);
  const std::uint32_t base = key(block);
  SampleBlock out;
  for (std::uint32_t lane = 0; lane < 8; ++lane)
    out[lane] = coordinate(reversed_sample, base + (lane / 2) * kGolden, base + (lane + 8) * kGolden, lane & 1u);
  return out;
}

std::array<Vec2f, 2> Sampler::two_points(std::uint32_t sample, std::uint32_t block) const {
  const std::uint32_t base = key(block);
  std::array<float, 4> out;
  for (std::uint32_t lane = 0; lane < 4; ++lane)
    out[lane] = coordinate(reverse_bits(2 * sample + lane / 2), base, base + ((lane & 1u) + 8) * kGolden, lane & 1u);
  return {Vec2f(out[0], out[1]), Vec2f(out[2], out[3])};
}

}  // namespace softreel
