/// Programs and canvases of OpenGL as objects. Part of the EGL back end, which alone may include it.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "render/image/image_io.h"
#include "render/preview/egl/egl_context.h"
#include "render/preview/egl/preview_shaders.h"
#include "render/preview/picture_regions.h"
#include "render/preview/read_pixels.h"

namespace softreel {

/// A linked program and its uniforms by name.
class GlProgram {
 public:
  GlProgram(const std::string& vertex, const std::string& fragment) : id_(glCreateProgram()) {
    for (const auto& [kind, text] : {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
      const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
      const char* source = text.c_str();
      glShaderSource(shader, 1, &source, nullptr);
      glCompileShader(shader);
      glAttachShader(id_, shader);
      glDeleteShader(shader);
    }
    glLinkProgram(id_);
    GLint linked = GL_FALSE;
    glGetProgramiv(id_, GL_LINK_STATUS, &linked);
    if (linked == GL_TRUE) return;
    char reason[512] = {};
    glGetProgramInfoLog(id_, sizeof reason, nullptr, reason);
    throw unusable(fmt::format("its OpenGL refuses a shader ({})", reason));
  }
  void use() const { glUseProgram(id_); }
  GLint at(const char* name) const { return glGetUniformLocation(id_, name); }
  GLint at(const char* name, int k) const { return at(fmt::format("{}[{}]", name, k).c_str()); }
  void set(const char* name, float value) const { glUniform1f(at(name), value); }
  void set(const char* name, int value) const { glUniform1i(at(name), value); }
  void set(const char* name, const Vec3f& value) const { glUniform3fv(at(name), 1, value.data()); }
  void set(const char* name, int k, const Vec3f& value) const { glUniform3fv(at(name, k), 1, value.data()); }
  void set(const char* name, int k, float value) const { glUniform1f(at(name, k), value); }
  void set(const char* name, int k, int value) const { glUniform1i(at(name, k), value); }

 private:
  GLuint id_;
};

/// Colour and depth of one picture: some samples a pixel in one part of it, and one in the rest.
class Canvas {
 public:
  /// samples: a pixel; 0 for one without anti-aliasing, which has no other part.
  Canvas(int width, int height, int samples) : width_(width), height_(height), samples_(samples) {
    require_size(width, height);
    glGenFramebuffers(2, framebuffers_);
    glGenRenderbuffers(4, buffers_);
    attach(framebuffers_[0], buffers_[0], buffers_[1], samples);
    if (samples > 0) attach(framebuffers_[1], buffers_[2], buffers_[3], 0);
  }
  ~Canvas() {
    glDeleteFramebuffers(2, framebuffers_);
    glDeleteRenderbuffers(4, buffers_);
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  bool is(int width, int height, int samples) const {
    return width == width_ && height == height_ && samples == samples_;
  }
  /// Drawing goes to the part with samples from now on, or to the one without.
  void bind_fine() const { bind(framebuffers_[0]); }
  void bind_coarse() const { bind(framebuffers_[1]); }

  /// fine: the part with samples. with_alpha: what was drawn is premultiplied, over nothing.
  DisplayImage read(bool with_alpha, const PixelRect& fine) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers_[0]);
    if (samples_ > 0) {
      glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffers_[1]);
      if (!fine.empty())
        glBlitFramebuffer(fine.left, fine.bottom, fine.right, fine.top, fine.left, fine.bottom, fine.right, fine.top,
                          GL_COLOR_BUFFER_BIT, GL_NEAREST);
      glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers_[1]);
    }
    std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return with_alpha ? transparent_picture(pixels, width_, height_) : opaque_picture(pixels, width_, height_);
  }

 private:
  static void require_size(int width, int height) {
    GLint most = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
    if (width <= most && height <= most) return;
    throw work_error(
        fmt::format("The preview cannot draw {} x {} pixels here.\n"
                    "  Accepted: at most {} to a side with this OpenGL. Set render.scale or render.crop, or render "
                    "with the path tracer instead.",
                    width, height, most));
  }
  void bind(GLuint framebuffer) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, width_, height_);
  }
  void attach(GLuint framebuffer, GLuint color, GLuint depth, int samples) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    for (const auto& [buffer, role, format] : {std::tuple(color, GL_COLOR_ATTACHMENT0, GL_RGBA8),
                                               std::tuple(depth, GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24)}) {
      glBindRenderbuffer(GL_RENDERBUFFER, buffer);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, static_cast<GLenum>(format), width_, height_);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, static_cast<GLenum>(role), GL_RENDERBUFFER, buffer);
    }
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw unusable(fmt::format("it has no room for a picture of {} x {} pixels", width_, height_));
  }

  int width_, height_, samples_;
  GLuint framebuffers_[2] = {};  ///< fine, coarse
  GLuint buffers_[4] = {};       ///< colours and depths of either
};

/// Depths of the bodies as lights see them: layers of one texture, compared when it is read.
class ShadowLayers {
 public:
  explicit ShadowLayers(int layers) {
    glGenTextures(1, &texture_);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, texture_);
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT24, kShadowSize, kShadowSize, layers, 0, GL_DEPTH_COMPONENT,
                 GL_UNSIGNED_INT, nullptr);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D_ARRAY, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D_ARRAY, wrap, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glGenFramebuffers(1, &framebuffer_);
  }
  ~ShadowLayers() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteTextures(1, &texture_);
  }
  ShadowLayers(const ShadowLayers&) = delete;
  ShadowLayers& operator=(const ShadowLayers&) = delete;

  /// Drawing goes to the cleared layer from now on; depths only.
  void bind(int layer) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, texture_, 0, layer);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);  // else some drivers take a framebuffer without colours for incomplete
    glViewport(0, 0, kShadowSize, kShadowSize);
    glClear(GL_DEPTH_BUFFER_BIT);
  }

 private:
  GLuint texture_ = 0, framebuffer_ = 0;
};

}  // namespace softreel
