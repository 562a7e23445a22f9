#include "render/pathtrace/materials/texture_lookup.h"

#include <algorithm>
#include <cmath>

namespace softreel {

namespace {

constexpr float kMostProbes = 16;

template <typename T>
T blend(const T& a, const T& b, float t) {
  return a + t * (b - a);  // of equal values exactly their value
}

/// The texel that stands for place i of a row of n.
int wrapped(int i, int n, TextureWrap wrap) {
  if (wrap == TextureWrap::Clamp) return std::clamp(i, 0, n - 1);
  const int period = wrap == TextureWrap::Mirror ? 2 * n : n;
  int k = i % period;
  if (k < 0) k += period;
  return k < n ? k : period - 1 - k;
}

/// Texture coordinates of any size to places in one level: whole repetitions are dropped before they lose digits.
float place(float coordinate, int n, TextureWrap wrap) {
  if (wrap == TextureWrap::Clamp)
    coordinate = std::clamp(coordinate, -1.0f, 2.0f);
  else
    coordinate -= 2 * std::floor(0.5f * coordinate);
  return coordinate * static_cast<float>(n) - 0.5f;
}

template <typename Texel>
Texel bilinear(const typename TexturePyramid<Texel>::Level& level, TextureWrap wrap, const Vec2f& at) {
  const float x = place(at.x(), level.width, wrap), y = place(1 - at.y(), level.height, wrap);
  const float left = std::floor(x), top = std::floor(y);
  const int x0 = wrapped(static_cast<int>(left), level.width, wrap);
  const int x1 = wrapped(static_cast<int>(left) + 1, level.width, wrap);
  const int y0 = wrapped(static_cast<int>(top), level.height, wrap);
  const int y1 = wrapped(static_cast<int>(top) + 1, level.height, wrap);
  const auto texel = [&level](int column, int row) -> const Texel& {
    return level.texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.width) +
                        static_cast<std::size_t>(column)];
  };
  const Texel upper = blend<Texel>(texel(x0, y0), texel(x1, y0), x - left);
  const Texel lower = blend<Texel>(texel(x0, y1), texel(x1, y1), x - left);
  return blend<Texel>(upper, lower, y - top);
}

/// depth: level of the pyramid, between two of them blended.
template <typename Texel>
Texel trilinear(const TexturePyramid<Texel>& texture, TextureWrap wrap, const Vec2f& at, float depth) {
  const int last = static_cast<int>(texture.levels.size()) - 1;
  const auto level = [&](int k) -> const auto& {
    return texture.levels[static_cast<std::size_t>(k)];
  };
  if (!(depth > 0)) return bilinear<Texel>(level(0), wrap, at);
  if (depth >= static_cast<float>(last)) return bilinear<Texel>(level(last), wrap, at);
  const int k = static_cast<int>(depth);
  return blend<Texel>(bilinear<Texel>(level(k), wrap, at), bilinear<Texel>(level(k + 1), wrap, at),
                      depth - static_cast<float>(k));
}

/// Width of the footprint in texels of the picture along one of its axes.
template <typename Texel>
float texels_across(const TexturePyramid<Texel>& texture, const Vec2f& half_axis) {
  const auto& picture = texture.levels.front();
  return 2 * std::hypot(half_axis.x() * static_cast<float>(picture.width),
                        half_axis.y() * static_cast<float>(picture.height));
}

template <typename Texel>
Texel filtered(const TexturePyramid<Texel>& texture, TextureWrap wrap, const TextureFootprint& footprint) {
  Vec2f major = footprint.a;
  float length = texels_across(texture, footprint.a), width = texels_across(texture, footprint.b);
  if (width > length) {
    std::swap(length, width);
    major = footprint.b;
  }
  if (!(length > 1)) return bilinear<Texel>(texture.levels.front(), wrap, footprint.center);
  const float probe = std::max({width, length / kMostProbes, 1.0f});
  const float depth = std::log2(probe);
  const int probes = static_cast<int>(std::ceil(length / probe));
  if (probes <= 1) return trilinear(texture, wrap, footprint.center, depth);
  Texel mean = Texel();
  for (int k = 0; k < probes; ++k) {
    const float share = (2 * static_cast<float>(k) + 1) / static_cast<float>(probes) - 1;
    const Texel value = trilinear<Texel>(texture, wrap, footprint.center + share * major, depth);
    mean = k == 0 ? value : blend<Texel>(mean, value, 1 / static_cast<float>(k + 1));
  }
  return mean;
}

}  // namespace

TextureGradients::TextureGradients(const Corners& positions, const std::array<Vec2f, 3>& coordinates) {
  const Vec3f e1 = positions[1] - positions[0], e2 = positions[2] - positions[0];
  const Vec3f normal = e1.cross(e2);
  const float square = normal.squaredNorm();
  if (!(square > 0)) return;
  // Gradients of the barycentric weights of corners 1 and 2.
  const Vec3f g1 = e2.cross(normal) / square, g2 = normal.cross(e1) / square;
  const Vec2f c1 = coordinates[1] - coordinates[0], c2 = coordinates[2] - coordinates[0];
  du = c1.x() * g1 + c2.x() * g2;
  dv = c1.y() * g1 + c2.y() * g2;
}

TextureFootprint cone_footprint(const TextureGradients& gradients, const Vec2f& center, const Vec3f& direction,
                                const Vec3f& normal, float width) {
  const float radius = 0.5f * width, cosine = std::max(std::abs(direction.dot(normal)), 1e-3f);
  Vec3f along = direction - direction.dot(normal) * normal;
  const float length = along.norm();
  along = length > 1e-6f ? Vec3f(along / length) : normal.unitOrthogonal();
  return {center, gradients.along((radius / cosine) * along), gradients.along(radius * normal.cross(along))};
}

float look_up(const DataTexture& texture, TextureWrap wrap, const TextureFootprint& footprint) {
  return filtered(texture, wrap, footprint);
}

Vec3f look_up(const ColorTexture& texture, TextureWrap wrap, const TextureFootprint& footprint) {
  return filtered(texture, wrap, footprint);
}

Vec2f look_up_slope(const DataTexture& texture, TextureWrap wrap, const TextureFootprint& footprint) {
  const auto& picture = texture.levels.front();
  const auto slope = [&](int axis, int texels) {
    const float extent = std::hypot(footprint.a[axis], footprint.b[axis]);
    const float step = std::max(extent, 0.5f / static_cast<float>(texels));
    TextureFootprint before = footprint, after = footprint;
    before.center[axis] -= step;
    after.center[axis] += step;
    return (look_up(texture, wrap, after) - look_up(texture, wrap, before)) / (2 * step);
  };
  return {slope(0, picture.width), slope(1, picture.height)};
}

}  // namespace softreel
