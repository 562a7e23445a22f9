#include "render/preview/closed_surface.h"

#include <algorithm>
#include <cstdint>

namespace softreel {
namespace {

/// Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, 2014: the last stage of SplitMix64.
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Opposite numbers, modulo 2^64, for the two directions of an edge.
std::uint64_t edge_hash(Index from, Index to) {
  const auto low = static_cast<std::uint64_t>(std::min(from, to)),
             high = static_cast<std::uint64_t>(std::max(from, to));
  const std::uint64_t hash = mixed((low << 32 | high) + 0x9e3779b97f4a7c15ULL);
  return from < to ? hash : ~hash + 1;
}

bool is_closed(const std::vector<Triangle>& triangles) {
  std::uint64_t sum = 0;
  for (const Triangle& t : triangles) sum += edge_hash(t[0], t[1]) + edge_hash(t[1], t[2]) + edge_hash(t[2], t[0]);
  return sum == 0;
}

/// Times 6.
double signed_volume(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles) {
  const auto at = [&](Index p) -> const Vec3f& { return positions[static_cast<std::size_t>(p)]; };
  const Vec3f origin = at(triangles.front()[0]);
  double sum = 0;
  for (const Triangle& t : triangles) {
    const Vec3f a = at(t[0]) - origin, b = at(t[1]) - origin, c = at(t[2]) - origin;
    sum += static_cast<double>(a.cross(b).dot(c));
  }
  return sum;
}

}  // namespace

SolidSide solid_side(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles) {
  if (triangles.empty() || !is_closed(triangles)) return SolidSide::None;
  const double volume = signed_volume(positions, triangles);
  return volume > 0 ? SolidSide::Behind : volume < 0 ? SolidSide::Before : SolidSide::None;
}

}  // namespace softreel
