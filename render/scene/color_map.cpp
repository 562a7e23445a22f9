#include "render/scene/color_map.h"

#include <algorithm>
#include <array>

#include "core/base/srgb.h"

namespace softreel {

Vec3f heat_code(float x) {
  static const std::array<Vec3f, 7> kCoefficients = {
      Vec3f(0.2777273272234177f, 0.005407344544966578f, 0.3340998053353061f),
      Vec3f(0.1050930431085774f, 1.404613529898575f, 1.384590162594685f),
      Vec3f(-0.3308618287255563f, 0.214847559468213f, 0.09509516302823659f),
      Vec3f(-4.634230498983486f, -5.799100973351585f, -19.33244095627987f),
      Vec3f(6.228269936347081f, 14.17993336680509f, 56.69055260068105f),
      Vec3f(4.776384997670288f, -13.74514537774601f, -65.35303263337234f),
      Vec3f(-5.435455855934631f, 4.645852612178535f, 26.3124352495832f)};
  const float t = x > 0 ? std::min(x, 1.0f) : 0.0f;
  Vec3f sum = kCoefficients[6];
  for (std::size_t k = 6; k-- > 0;) sum = kCoefficients[k] + t * sum;
  return sum.cwiseMax(0.0f).cwiseMin(1.0f);
}

Vec3f heat_color(float x) {
  const Vec3f code = heat_code(x);
  return {srgb_decode(code.x()), srgb_decode(code.y()), srgb_decode(code.z())};
}

std::vector<Vec3f> vertex_base_colors(const MotionMesh& mesh) {
  const SurfaceColoring& coloring = mesh.coloring;
  if (coloring.heat.empty()) return coloring.colors;
  std::vector<Vec3f> colors;
  colors.reserve(coloring.heat.size());
  for (const float value : coloring.heat) colors.push_back(heat_color(value));
  return colors;
}

}  // namespace softreel
