#include "render/preview/egl/gpu_textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/srgb.h"

namespace softreel {
namespace {

constexpr int kCodeSteps = 1 << 16;  ///< so fine that dark colours, too, get the nearest of 256 codes or the one beside

/// sRGB codes of linear values k / kCodeSteps: the curve itself would take a second for a large picture.
const std::vector<std::uint8_t>& srgb_codes() {
  static const std::vector<std::uint8_t> codes = [] {
    std::vector<std::uint8_t> table;
    table.reserve(kCodeSteps + 1);
    for (int k = 0; k <= kCodeSteps; ++k)
      table.push_back(
          static_cast<std::uint8_t>(std::lround(255 * srgb_encode(static_cast<float>(k) / float{kCodeSteps}))));
    return table;
  }();
  return codes;
}

std::vector<std::uint8_t> color_codes(const std::vector<Vec3f>& texels) {
  const std::vector<std::uint8_t>& codes = srgb_codes();
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * texels.size());
  for (const Vec3f& c : texels)
    for (int k = 0; k < 3; ++k)
      bytes.push_back(codes[static_cast<std::size_t>(std::clamp(c[k], 0.0f, 1.0f) * kCodeSteps + 0.5f)]);
  return bytes;
}

GLint wrapping(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::Clamp:
      return GL_CLAMP_TO_EDGE;
    case TextureWrap::Mirror:
      return GL_MIRRORED_REPEAT;
    case TextureWrap::Repeat:
      break;
  }
  return GL_REPEAT;
}

/// Sends the levels that OpenGL takes; `send` one, at a place.
template <typename Texel, typename Send>
void fill(const TexturePyramid<Texel>& texture, const Send& send) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  GLint place = 0;
  for (const auto& level : texture.levels)
    if (std::max(level.width, level.height) <= largest) send(place++, level);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, place - 1);
}

}  // namespace

GpuTextures::~GpuTextures() {
  for (const auto& [texture, name] : names_) glDeleteTextures(1, &name);
}

bool GpuTextures::bind(GLuint unit, const std::shared_ptr<const void>& texture, TextureWrap wrap) {
  GLuint& name = names_[texture];
  const bool is_new = name == 0;
  if (is_new) glGenTextures(1, &name);
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_2D, name);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTexParameteri(GL_TEXTURE_2D, axis, wrapping(wrap));
  return is_new;
}

void GpuTextures::bind_colors(GLuint unit, const std::shared_ptr<const ColorTexture>& texture, TextureWrap wrap) {
  if (!bind(unit, texture, wrap)) return;
  fill(*texture, [](GLint place, const ColorTexture::Level& level) {
    const std::vector<std::uint8_t> codes = color_codes(level.texels);
    glTexImage2D(GL_TEXTURE_2D, place, GL_SRGB8, level.width, level.height, 0, GL_RGB, GL_UNSIGNED_BYTE, codes.data());
  });
}

void GpuTextures::bind_shares(GLuint unit, const std::shared_ptr<const DataTexture>& texture, TextureWrap wrap) {
  if (!bind(unit, texture, wrap)) return;
  fill(*texture, [](GLint place, const DataTexture::Level& level) {
    glTexImage2D(GL_TEXTURE_2D, place, GL_R8, level.width, level.height, 0, GL_RED, GL_FLOAT, level.texels.data());
  });
}

void GpuTextures::bind_normals(GLuint unit, const std::shared_ptr<const ColorTexture>& texture, TextureWrap wrap) {
  if (!bind(unit, texture, wrap)) return;
  fill(*texture, [](GLint place, const ColorTexture::Level& level) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    glTexImage2D(GL_TEXTURE_2D, place, GL_RGB32F, level.width, level.height, 0, GL_RGB, GL_FLOAT, level.texels.data());
  });
}

void GpuTextures::bind_heights(GLuint unit, const std::shared_ptr<const DataTexture>& texture, TextureWrap wrap) {
  if (!bind(unit, texture, wrap)) return;
  fill(*texture, [](GLint place, const DataTexture::Level& level) {
    glTexImage2D(GL_TEXTURE_2D, place, GL_R32F, level.width, level.height, 0, GL_RED, GL_FLOAT, level.texels.data());
  });
}

}  // namespace softreel
