/// Programs, canvases and buffers of OpenGL as objects. Part of preview_egl.cpp, which alone may include it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "render/image/image_io.h"
#include "render/preview/egl/egl_context.h"
#include "render/preview/egl/preview_shaders.h"
#include "render/preview/gizmo_marks.h"
#include "render/scene/scene.h"

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

/// Colour and depth of one picture with some samples a pixel, and the plain picture they are resolved to.
class Canvas {
 public:
  /// samples: a pixel; 0 for one without anti-aliasing.
  Canvas(int width, int height, int samples) : width_(width), height_(height), samples_(samples) {
    glGenFramebuffers(2, framebuffers_);
    glGenRenderbuffers(3, buffers_);
    attach(framebuffers_[0], buffers_[0], GL_COLOR_ATTACHMENT0, GL_RGBA8, samples);
    attach(framebuffers_[0], buffers_[1], GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, samples);
    attach(framebuffers_[1], buffers_[2], GL_COLOR_ATTACHMENT0, GL_RGBA8, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers_[0]);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw unusable(fmt::format("it has no room for a picture of {} x {} pixels", width, height));
  }
  ~Canvas() {
    glDeleteFramebuffers(2, framebuffers_);
    glDeleteRenderbuffers(3, buffers_);
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  bool is(int width, int height, int samples) const {
    return width == width_ && height == height_ && samples == samples_;
  }
  /// Drawing goes here from now on.
  void bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers_[0]);
    glViewport(0, 0, width_, height_);
  }

  DisplayImage read() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers_[0]);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffers_[1]);
    glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers_[1]);
    const std::size_t row = 3 * static_cast<std::size_t>(width_), rows = static_cast<std::size_t>(height_);
    std::vector<std::uint8_t> upside_down(row * rows);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, upside_down.data());
    DisplayImage image{width_, height_, std::vector<std::uint8_t>(row * rows)};
    for (std::size_t y = 0; y < rows; ++y) std::memcpy(&image.pixels[y * row], &upside_down[(rows - 1 - y) * row], row);
    return image;
  }

 private:
  void attach(GLuint framebuffer, GLuint buffer, GLenum role, GLenum format, int samples) const {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width_, height_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, role, GL_RENDERBUFFER, buffer);
  }

  int width_, height_, samples_;
  GLuint framebuffers_[2] = {};
  GLuint buffers_[3] = {};
};

/// Depths of the bodies as lights see them: layers of one texture, compared when it is read.
class ShadowLayers {
 public:
  explicit ShadowLayers(int layers) {
    glGenTextures(1, &texture_);
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
    glViewport(0, 0, kShadowSize, kShadowSize);
    glClear(GL_DEPTH_BUFFER_BIT);
  }

 private:
  GLuint texture_ = 0, framebuffer_ = 0;
};

/// A mesh at the closing of the shutter, in buffers that live on from frame to frame.
class GpuMesh {
 public:
  GpuMesh() {
    glGenVertexArrays(1, &array_);
    glGenBuffers(4, buffers_);
  }
  ~GpuMesh() {
    glDeleteBuffers(4, buffers_);
    glDeleteVertexArrays(1, &array_);
  }
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;

  /// Where it has no colour of its own at the vertices it takes base_color.
  void upload(const MotionMesh& mesh, const std::vector<Vec3f>& colors) {
    const MotionMesh::Time& time = mesh.times.back();
    base_color_ = mesh.appearance.base_color;
    has_colors_ = !colors.empty();
    glBindVertexArray(array_);
    fill(0, time.positions);
    fill(1, time.normals);
    fill(2, colors);
    send(GL_ELEMENT_ARRAY_BUFFER, buffers_[3], mesh.triangles);
    indices_ = static_cast<GLsizei>(3 * mesh.triangles.size());
  }
  void draw() const {
    glBindVertexArray(array_);
    if (!has_colors_) glVertexAttrib3fv(2, base_color_.data());
    glDrawElements(GL_TRIANGLES, indices_, GL_UNSIGNED_INT, nullptr);
  }

 private:
  template <typename T>
  static void send(GLenum target, GLuint buffer, const std::vector<T>& values) {
    glBindBuffer(target, buffer);
    glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(), GL_STREAM_DRAW);
  }
  /// An attribute per vertex; without values the vertices share one.
  void fill(GLuint attribute, const std::vector<Vec3f>& values) {
    if (values.empty()) {
      glDisableVertexAttribArray(attribute);
      return;
    }
    send(GL_ARRAY_BUFFER, buffers_[attribute], values);
    glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(attribute);
  }

  GLuint array_ = 0;
  GLuint buffers_[4] = {};  ///< positions, normals, colours, triangles
  GLsizei indices_ = 0;
  bool has_colors_ = false;
  Vec3f base_color_ = Vec3f::Zero();
};

/// Buffers of the triangles that marks are drawn as.
class GpuMarks {
 public:
  GpuMarks() {
    glGenVertexArrays(1, &array_);
    glGenBuffers(1, &buffer_);
    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    add_attribute(0, 4, offsetof(OverlayVertex, clip));
    add_attribute(1, 2, offsetof(OverlayVertex, disk));
    add_attribute(2, 3, offsetof(OverlayVertex, color));
  }
  ~GpuMarks() {
    glDeleteBuffers(1, &buffer_);
    glDeleteVertexArrays(1, &array_);
  }
  GpuMarks(const GpuMarks&) = delete;
  GpuMarks& operator=(const GpuMarks&) = delete;

  void draw(const std::vector<OverlayVertex>& triangles) const {
    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * sizeof(OverlayVertex)), triangles.data(),
                 GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(triangles.size()));
  }

 private:
  static void add_attribute(GLuint attribute, GLint numbers, std::size_t offset) {
    glVertexAttribPointer(attribute, numbers, GL_FLOAT, GL_FALSE, sizeof(OverlayVertex),
                          reinterpret_cast<const void*>(offset));
    glEnableVertexAttribArray(attribute);
  }

  GLuint array_ = 0, buffer_ = 0;
};

}  // namespace softreel
