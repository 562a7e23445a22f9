#include "tool/report/cut_colors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/tetmesh/quality/tet_quality.h"

namespace softreel {
namespace {

/// Colours of the smallest dihedral angles 0, 10, ... 60 degrees; between them they are blended.
const std::array<Vec3f, 7> kAngleColors = {
    Vec3f(0.33f, 0.01f, 0.02f), Vec3f(0.52f, 0.04f, 0.02f), Vec3f(0.66f, 0.13f, 0.03f), Vec3f(0.72f, 0.27f, 0.06f),
    Vec3f(0.74f, 0.40f, 0.11f), Vec3f(0.75f, 0.50f, 0.18f), Vec3f(0.76f, 0.56f, 0.24f)};

}  // namespace

Vec3f outer_color() {
  return {0.24f, 0.38f, 0.54f};
}

Vec3f outer_line_color() {
  return {0.035f, 0.06f, 0.09f};
}

Vec3f cut_line_color() {
  return {0.10f, 0.06f, 0.03f};
}

Vec3f angle_tint_color(std::size_t tint) {
  const double place = static_cast<double>(tint) * (kAngleColors.size() - 1) / (kAngleTints - 1);
  const auto low = std::min(static_cast<std::size_t>(place), kAngleColors.size() - 2);
  const auto share = static_cast<float>(place - static_cast<double>(low));
  return (1 - share) * kAngleColors[low] + share * kAngleColors[low + 1];
}

std::size_t angle_tint(const std::array<Vec3, 4>& corners) {
  const auto& [a, b, c, d] = corners;
  if (!(tet_volume(a, b, c, d) > 0)) return 0;
  const double share = dihedral_range(a, b, c, d).min / (std::numbers::pi / 3);
  if (!(share > 0)) return 0;
  return std::min(static_cast<std::size_t>(std::lround(share * (kAngleTints - 1))), kAngleTints - 1);
}

}  // namespace softreel
