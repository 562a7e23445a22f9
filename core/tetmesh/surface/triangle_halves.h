/// How large triangles are cut before they are sorted into cells of space.
#pragma once

#include <array>

#include "core/base/types.h"

namespace softreel {

using TriangleCorners = std::array<Vec3, 3>;

/// A triangle cut from the middle of its longest side to the corner opposite. Pieces of a needle are as many as it is
/// long, where quarters would be as many as the square of that.
inline std::array<TriangleCorners, 2> halved(const TriangleCorners& x) {
  std::size_t k = 0;
  const auto side = [&](std::size_t j) { return (x[j] - x[(j + 1) % 3]).squaredNorm(); };
  for (std::size_t j = 1; j < 3; ++j)
    if (side(j) > side(k)) k = j;
  const Vec3 &a = x[k], &b = x[(k + 1) % 3], &c = x[(k + 2) % 3], middle = 0.5 * (a + b);
  return {TriangleCorners{a, middle, c}, TriangleCorners{middle, b, c}};
}

}  // namespace softreel
