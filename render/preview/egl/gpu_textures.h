/// Textures of materials in OpenGL. Part of the EGL back end, which alone may include it.
#pragma once

#include <map>
#include <memory>

#include <epoxy/gl.h>

#include "render/scene/texture.h"

namespace softreel {

/// The textures of the scenes that were drawn, each sent once, with the halvings that it has. A picture that is larger
/// than OpenGL takes starts at its first halving that is not.
class GpuTextures {
 public:
  GpuTextures() = default;
  ~GpuTextures();
  GpuTextures(const GpuTextures&) = delete;
  GpuTextures& operator=(const GpuTextures&) = delete;

  /// Bind a texture to a unit. Colours have 8 bits on the sRGB curve, shares 8 bits, normals and heights 32.
  void bind_colors(GLuint unit, const std::shared_ptr<const ColorTexture>& texture, TextureWrap wrap);
  void bind_shares(GLuint unit, const std::shared_ptr<const DataTexture>& texture, TextureWrap wrap);
  void bind_normals(GLuint unit, const std::shared_ptr<const ColorTexture>& texture, TextureWrap wrap);
  void bind_heights(GLuint unit, const std::shared_ptr<const DataTexture>& texture, TextureWrap wrap);

 private:
  /// True if it is new and has to be filled; it is bound.
  bool bind(GLuint unit, const std::shared_ptr<const void>& texture, TextureWrap wrap);

  std::map<std::shared_ptr<const void>, GLuint> names_;
};

}  // namespace softreel
