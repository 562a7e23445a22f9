/// The only place that knows EGL and OpenGL.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include "core/base/error.h"
#include "render/preview/preview.h"
#include "render/preview/preview_shaders.h"
#include "render/scene/camera_frame.h"
#include "render/scene/environment_radiance.h"
#include "render/scene/ground_mesh.h"

namespace softreel {

namespace {

constexpr int kAntiAliasing = 4;  ///< samples a pixel
constexpr float kPi = 3.14159265f;

Error unusable(const std::string& what) {
  return work_error(fmt::format(
      "The preview cannot draw: {}.\n"
      "  Accepted: EGL with OpenGL 3.3, on a GPU or in software. Install libegl1 and libgl1-mesa-dri, or render "
      "with the path tracer instead.",
      what));
}

bool lists(const char* extensions, const char* name) {
  return extensions != nullptr && std::strstr(extensions, name) != nullptr;
}

/// A current context that draws into framebuffers only; ends with its scope.
class EglContext {
 public:
  EglContext() {
    open_display();
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) throw unusable("this EGL has no desktop OpenGL");
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    const EGLint version[] = {
        EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK, 1, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglChooseConfig(display_, wanted, &config, 1, &count) == EGL_TRUE && count > 0)
      context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version);
    if (context_ == EGL_NO_CONTEXT) {
      eglTerminate(display_);
      throw unusable(fmt::format("no OpenGL 3.3 context (EGL error {:#x})", eglGetError()));
    }
  }
  ~EglContext() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() const {
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
      throw unusable(fmt::format("its context does not start (EGL error {:#x})", eglGetError()));
  }
  std::string version() const { return fmt::format("EGL {}.{}", major_, minor_); }

 private:
  bool initialised(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || eglInitialize(display, &major_, &minor_) != EGL_TRUE) return false;
    if (!lists(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
      eglTerminate(display);
      return false;
    }
    display_ = display;
    return true;
  }

  /// Mesa without a window system, else the first device that works.
  void open_display() {
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!lists(extensions, "EGL_EXT_platform_base")) throw unusable("this EGL knows no platform without a window");
    if (lists(extensions, "EGL_MESA_platform_surfaceless") &&
        initialised(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)))
      return;
    if (lists(extensions, "EGL_EXT_device_enumeration") && lists(extensions, "EGL_EXT_platform_device")) {
      EGLDeviceEXT devices[16];
      EGLint count = 0;
      if (eglQueryDevicesEXT(16, devices, &count) != EGL_TRUE) count = 0;
      for (EGLint k = 0; k < count; ++k)
        if (initialised(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[k], nullptr))) return;
    }
    throw unusable("no EGL device can be opened");
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLint major_ = 0, minor_ = 0;
};

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
  void set(const char* name, float value) const { glUniform1f(at(name), value); }
  void set(const char* name, int value) const { glUniform1i(at(name), value); }
  void set(const char* name, const Vec3f& value) const { glUniform3fv(at(name), 1, value.data()); }
  void set(const char* name, int k, const Vec3f& value) const {
    glUniform3fv(at(fmt::format("{}[{}]", name, k).c_str()), 1, value.data());
  }

 private:
  GLuint id_;
};

/// Colour and depth of one picture, anti-aliased, and the plain picture they are resolved to.
class Canvas {
 public:
  Canvas(int width, int height) : width_(width), height_(height) {
    glGenFramebuffers(2, framebuffers_);
    glGenRenderbuffers(3, buffers_);
    attach(framebuffers_[0], buffers_[0], GL_COLOR_ATTACHMENT0, GL_RGBA8, kAntiAliasing);
    attach(framebuffers_[0], buffers_[1], GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, kAntiAliasing);
    attach(framebuffers_[1], buffers_[2], GL_COLOR_ATTACHMENT0, GL_RGBA8, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers_[0]);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw unusable(fmt::format("it has no room for a picture of {} x {} pixels", width, height));
    glViewport(0, 0, width, height);
  }
  ~Canvas() {
    glDeleteFramebuffers(2, framebuffers_);
    glDeleteRenderbuffers(3, buffers_);
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

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

  int width_, height_;
  GLuint framebuffers_[2] = {};
  GLuint buffers_[3] = {};
};

/// Clip coordinates: the camera's window fills the picture, depth from `near` to `far` metres.
Eigen::Matrix4f clip_from_world(const CameraFrame& camera, float near, float far) {
  Eigen::Matrix4f clip;
  clip.row(0) << camera.right.transpose() / camera.half_width, 0;
  clip.row(1) << camera.up.transpose() / camera.half_height, 0;
  clip.row(2) << camera.forward.transpose() * ((far + near) / (far - near)), -2 * far * near / (far - near);
  clip.row(3) << camera.forward.transpose(), 0;
  Eigen::Matrix4f shift = Eigen::Matrix4f::Identity();
  shift.block<3, 1>(0, 3) = -camera.position;
  return clip * shift;
}

/// Distance along the view that holds all of the meshes, with a little air.
float farthest(const std::vector<const MotionMesh*>& meshes, const CameraFrame& camera) {
  float far = 1;
  for (const MotionMesh* mesh : meshes)
    for (const Vec3f& p : mesh->times.back().positions) far = std::max(far, (p - camera.position).dot(camera.forward));
  return 1.01f * far;
}

/// The environment as the shaders know it; an image is averaged around pole, horizon and pole.
Environment as_gradient(const Environment& environment) {
  if (!environment.image) return environment;
  const auto mean = [&](float low, float high) {
    constexpr int kRows = 16, kColumns = 32;
    Vec3f sum = Vec3f::Zero();
    for (int r = 0; r < kRows; ++r)
      for (int c = 0; c < kColumns; ++c) {
        const float y = low + (high - low) * (static_cast<float>(r) + 0.5f) / kRows;
        const float azimuth = 2 * kPi * (static_cast<float>(c) + 0.5f) / kColumns, ring = std::sqrt(1 - y * y);
        sum += environment_radiance(environment, Vec3f(ring * std::sin(azimuth), y, ring * std::cos(azimuth)));
      }
    return Vec3f(sum / (kRows * kColumns));
  };
  Environment gradient;
  gradient.zenith = mean(0.4f, 1);
  gradient.horizon = mean(-0.3f, 0.3f);
  gradient.nadir = mean(-1, -0.4f);
  return gradient;
}

class EglPreview : public Preview {
 public:
  EglPreview() {
    context_.make_current();
    const std::string common = std::string(kEnvironmentFunctions) + kDisplayFunctions;
    surface_ = std::make_unique<GlProgram>(kSurfaceVertexShader, common + kSurfaceFragmentShader);
    background_ = std::make_unique<GlProgram>(kBackgroundVertexShader, common + kBackgroundFragmentShader);
    glGenVertexArrays(1, &arrays_);
    glGenBuffers(3, buffers_);
  }
  DisplayImage draw(const Scene& scene, int width, int height, ViewTransform view, float exposure) override;
  std::string description() const override {
    context_.make_current();
    return fmt::format("{}, {}, OpenGL {}", context_.version(), reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                       reinterpret_cast<const char*>(glGetString(GL_VERSION)));
  }

 private:
  void set_common(const GlProgram& program, const Environment& gradient, ViewTransform view, float exposure) const;
  void set_lights(const Scene& scene) const;
  void set_ground(const Ground& ground, const Camera& camera) const;
  void draw_background(const CameraFrame& camera) const;
  void draw_mesh(const MotionMesh& mesh) const;

  EglContext context_;
  std::unique_ptr<GlProgram> surface_, background_;
  GLuint arrays_ = 0;
  GLuint buffers_[3] = {};  ///< positions, normals, triangles
};

void EglPreview::set_common(const GlProgram& program, const Environment& gradient, ViewTransform view,
                            float exposure) const {
  program.use();
  program.set("zenith", Vec3f(gradient.strength * gradient.zenith));
  program.set("horizon", Vec3f(gradient.strength * gradient.horizon));
  program.set("nadir", Vec3f(gradient.strength * gradient.nadir));
  program.set("exposure_scale", std::exp2(exposure));
  program.set("view", static_cast<int>(view));
}

void EglPreview::set_lights(const Scene& scene) const {
  // More lights than the shader has room for: the first ones, which a shot lists by importance.
  const int lamps = std::min(static_cast<int>(scene.area_lights.size()), kMaxPreviewLamps);
  const int suns = std::min(static_cast<int>(scene.suns.size()), kMaxPreviewSuns);
  surface_->set("lamps", lamps);
  surface_->set("suns", suns);
  for (int k = 0; k < lamps; ++k) {
    const AreaLight& lamp = scene.area_lights[static_cast<std::size_t>(k)];
    const Vec3f normal = lamp.u.cross(lamp.v);
    surface_->set("lamp_center", k, lamp.center);
    surface_->set("lamp_normal", k, normal.normalized());
    surface_->set("lamp_radiance", k, lamp.radiance);
    glUniform1f(surface_->at(fmt::format("lamp_area[{}]", k).c_str()), 4 * normal.norm());
  }
  for (int k = 0; k < suns; ++k) {
    const SunLight& sun = scene.suns[static_cast<std::size_t>(k)];
    surface_->set("sun_towards", k, Vec3f(-sun.direction.normalized()));
    surface_->set("sun_irradiance", k, sun.irradiance);
  }
}

void EglPreview::set_ground(const Ground& ground, const Camera& camera) const {
  const GroundPattern pattern(ground, camera);
  const bool plane = ground.style == GroundStyle::Plane;
  surface_->set("is_ground", 1);
  surface_->set("upright_ground", plane ? 1 : 0);
  surface_->set("checker", ground.checker);
  surface_->set("checker_color", ground.checker_color);
  surface_->set("ground_height", ground.height);
  surface_->set("sweep", ground.sweep);
  surface_->set("across", pattern.across());
  surface_->set("along", pattern.along());
  // The plane's edge fades into the sky; a backdrop fills the picture.
  surface_->set("fade_start", plane ? 0.35f * ground.size : 1e30f);
  surface_->set("fade_end", plane ? 0.5f * ground.size : 2e30f);
}

void EglPreview::draw_background(const CameraFrame& camera) const {
  glDisable(GL_DEPTH_TEST);
  background_->set("forward", camera.forward);
  background_->set("right", Vec3f(camera.half_width * camera.right));
  background_->set("up", Vec3f(camera.half_height * camera.up));
  glBindVertexArray(arrays_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
}

void EglPreview::draw_mesh(const MotionMesh& mesh) const {
  const MotionMesh::Time& time = mesh.times.back();
  const Appearance& look = mesh.appearance;
  surface_->set("base_color", look.base_color);
  surface_->set("emission", look.emission);
  surface_->set("roughness", look.roughness);
  surface_->set("metallic", look.metallic);
  surface_->set("specular", look.specular);
  surface_->set("transmission", look.transmission);
  surface_->set("flat_normals", time.normals.empty() ? 1 : 0);
  glBindVertexArray(arrays_);
  const auto upload = [](GLenum target, GLuint buffer, const auto& values) {
    glBindBuffer(target, buffer);
    glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(values[0])), values.data(), GL_STREAM_DRAW);
  };
  upload(GL_ARRAY_BUFFER, buffers_[0], time.positions);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(0);
  if (time.normals.empty()) {
    glDisableVertexAttribArray(1);
  } else {
    upload(GL_ARRAY_BUFFER, buffers_[1], time.normals);
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(1);
  }
  upload(GL_ELEMENT_ARRAY_BUFFER, buffers_[2], mesh.triangles);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh.triangles.size()), GL_UNSIGNED_INT, nullptr);
}

DisplayImage EglPreview::draw(const Scene& scene, int width, int height, ViewTransform view, float exposure) {
  const CameraFrame camera = camera_frame(scene.camera, width, height);
  const MotionMesh ground = scene.ground ? ground_mesh(*scene.ground, scene.camera) : MotionMesh{};
  std::vector<const MotionMesh*> meshes;
  for (const MotionMesh& mesh : scene.meshes) meshes.push_back(&mesh);
  if (scene.ground) meshes.push_back(&ground);

  context_.make_current();
  const Canvas canvas(width, height);
  glClear(GL_DEPTH_BUFFER_BIT);
  const Environment gradient = as_gradient(scene.environment);
  set_common(*background_, gradient, view, exposure);
  draw_background(camera);
  set_common(*surface_, gradient, view, exposure);
  set_lights(scene);
  const float far = farthest(meshes, camera);
  glUniformMatrix4fv(surface_->at("clip_from_world"), 1, GL_FALSE,
                     clip_from_world(camera, 1e-3f * far, far).eval().data());
  surface_->set("eye", camera.position);
  for (const MotionMesh* mesh : meshes) {
    surface_->set("is_ground", 0);
    if (mesh == &ground) set_ground(*scene.ground, scene.camera);
    draw_mesh(*mesh);
  }
  DisplayImage image = canvas.read();
  if (const GLenum failure = glGetError(); failure != GL_NO_ERROR)
    throw unusable(fmt::format("OpenGL error {:#x} while drawing {} x {} pixels", failure, width, height));
  return image;
}

}  // namespace

std::unique_ptr<Preview> softreel_make_egl_preview() {
  return std::make_unique<EglPreview>();
}

}  // namespace softreel
