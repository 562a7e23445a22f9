#include "render/image/texture_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/srgb.h"
#include "render/image/image_io.h"

namespace softreel {

namespace {

/// Texels [first, first + count) of a row, the outer ones weighted by how much of them a coarse texel covers.
struct Cover {
  int first = 0, count = 0;
  std::array<float, 3> weights{};  ///< sum 1
};

/// Coarse texel k of `coarse`, over a row of `fine` = 2 coarse or 2 coarse + 1 texels (or 1 over 1).
Cover cover(int k, int coarse, int fine) {
  if (fine == 1) return {0, 1, {1, 0, 0}};
  if (fine == 2 * coarse) return {2 * k, 2, {0.5f, 0.5f, 0}};
  // From k fine / coarse to (k + 1) fine / coarse: the part of the first texel, a whole one, the part of the last.
  const auto n = static_cast<float>(fine), m = static_cast<float>(coarse), at = static_cast<float>(k);
  return {2 * k, 3, {(m - at) / n, m / n, (at + 1) / n}};
}

/// Weighted mean; of equal values exactly their value.
template <typename Texel, typename At>
Texel mean_of(const Cover& c, const At& at) {
  const Texel base = at(c.first);
  Texel sum = base;
  for (int k = 1; k < c.count; ++k) sum += c.weights[static_cast<std::size_t>(k)] * (at(c.first + k) - base);
  return sum;
}

template <typename Texel>
typename TexturePyramid<Texel>::Level halved(const typename TexturePyramid<Texel>::Level& fine) {
  typename TexturePyramid<Texel>::Level coarse;
  coarse.width = std::max(1, fine.width / 2);
  coarse.height = std::max(1, fine.height / 2);
  coarse.texels.reserve(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height));
  for (int y = 0; y < coarse.height; ++y) {
    const Cover rows = cover(y, coarse.height, fine.height);
    for (int x = 0; x < coarse.width; ++x) {
      const Cover columns = cover(x, coarse.width, fine.width);
      const auto in_row = [&](int row) -> Texel {
        return mean_of<Texel>(columns, [&](int column) -> Texel {
          return fine.texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(fine.width) +
                             static_cast<std::size_t>(column)];
        });
      };
      coarse.texels.push_back(mean_of<Texel>(rows, in_row));
    }
  }
  return coarse;
}

template <typename Texel>
TexturePyramid<Texel> pyramid_of(int width, int height, std::vector<Texel> texels) {
  CHECK(width > 0);
  CHECK(height > 0);
  CHECK(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  TexturePyramid<Texel> pyramid;
  pyramid.levels.push_back({width, height, std::move(texels)});
  while (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1)
    pyramid.levels.push_back(halved<Texel>(pyramid.levels.back()));
  return pyramid;
}

/// Names the first texel that `is_good` refuses.
template <typename IsGood>
void require(const TexturePicture& picture, const std::string& path, const IsGood& is_good, const char* accepted) {
  for (std::size_t k = 0; k < picture.pixels.size(); ++k) {
    const Vec3f& c = picture.pixels[k];
    if (is_good(c)) continue;
    const auto width = static_cast<std::size_t>(picture.width);
    throw input_error(
        fmt::format("{}: pixel ({}, {}) has the values ({}, {}, {}).\n  Accepted: {}. Repair the picture.", path,
                    k % width, k / width, c.x(), c.y(), c.z(), accepted));
  }
}

bool is_share(float x) {
  return x >= 0 && x <= 1;
}

}  // namespace

ColorTexture make_pyramid(int width, int height, std::vector<Vec3f> texels) {
  return pyramid_of(width, height, std::move(texels));
}

DataTexture make_pyramid(int width, int height, std::vector<float> texels) {
  return pyramid_of(width, height, std::move(texels));
}

ColorTexture read_color_texture(const std::string& path) {
  TexturePicture picture = read_texture_picture(path);
  require(
      picture, path, [](const Vec3f& c) { return is_share(c.x()) && is_share(c.y()) && is_share(c.z()); },
      "colours from 0 to 1, as a surface gives back no more light than it gets");
  if (picture.bits < 32)
    for (Vec3f& c : picture.pixels) c = Vec3f(srgb_decode(c.x()), srgb_decode(c.y()), srgb_decode(c.z()));
  return make_pyramid(picture.width, picture.height, std::move(picture.pixels));
}

DataTexture read_data_texture(const std::string& path, bool is_a_share) {
  const TexturePicture picture = read_texture_picture(path);
  if (is_a_share)
    require(
        picture, path, [](const Vec3f& c) { return is_share(c.y()); }, "a green channel from 0 to 1");
  else
    require(
        picture, path, [](const Vec3f& c) { return std::isfinite(c.y()); }, "finite numbers in the green channel");
  std::vector<float> values;
  values.reserve(picture.pixels.size());
  for (const Vec3f& c : picture.pixels) values.push_back(c.y());
  return make_pyramid(picture.width, picture.height, std::move(values));
}

ColorTexture read_normal_texture(const std::string& path) {
  TexturePicture picture = read_texture_picture(path);
  require(
      picture, path, [](const Vec3f& c) { return c.allFinite(); }, "finite numbers");
  const float most = picture.bits == 8 ? 255 : 65535, middle = picture.bits == 8 ? 128 : 32768;
  for (Vec3f& c : picture.pixels) {
    if (picture.bits == 32)
      c = 2 * c - Vec3f::Ones();
    else  // the code values are whole numbers again before the middle is taken off, so that flat is exactly flat
      c = Vec3f((most * c).array().round() - middle).cwiseMax(1 - middle) / (most - middle);
  }
  return make_pyramid(picture.width, picture.height, std::move(picture.pixels));
}

}  // namespace softreel
