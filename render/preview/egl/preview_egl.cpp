/// The preview on EGL. It and the headers in egl/ are the only places that know EGL and OpenGL.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/preview/egl/egl_context.h"
#include "render/preview/egl/gl_objects.h"
#include "render/preview/egl/preview_shaders.h"
#include "render/preview/preview.h"
#include "render/preview/shadow_views.h"
#include "render/scene/camera_frame.h"
#include "render/scene/color_map.h"
#include "render/scene/environment_radiance.h"
#include "render/scene/ground_mesh.h"

namespace softreel {

namespace {

constexpr int kAntiAliasing = 4;  ///< samples a pixel
constexpr float kPi = 3.14159265f;
constexpr float kVertexLitSize = 5;  ///< pixels: smaller triangles are lit at their vertices

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

/// Distance along the view that holds all that is drawn, with a little air.
float farthest(const std::vector<MotionMesh>& meshes, const MotionMesh& ground, const GizmoMarks& marks,
               const CameraFrame& camera) {
  float far = 1;
  const auto add = [&](const Vec3f& p) { far = std::max(far, (p - camera.position).dot(camera.forward)); };
  for (const MotionMesh& mesh : meshes)
    for (const Vec3f& p : mesh.times.back().positions) add(p);
  if (!ground.times.empty())
    for (const Vec3f& p : ground.times.back().positions) add(p);
  for (const GizmoMarks::Dot& dot : marks.dots) add(dot.at);
  for (const GizmoMarks::Line& line : marks.lines) {
    add(line.from);
    add(line.to);
  }
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

/// What a lamp shows to a point that it faces, m^2.
float seen_area(const AreaLight& lamp) {
  switch (lamp.shape) {
    case LampShape::Rectangle:
      return 4 * lamp.u.cross(lamp.v).norm();
    case LampShape::Disk:
      return kPi * lamp.u.cross(lamp.v).norm();
    case LampShape::Sphere:
      break;
  }
  return kPi * lamp.u.squaredNorm();
}

/// Root of the mean area of a mesh's triangles as pixels at its mean distance, face on.
float triangle_size(const MotionMesh& mesh, const CameraFrame& camera, int width) {
  const std::vector<Vec3f>& positions = mesh.times.back().positions;
  double area = 0, depth = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3f &a = positions[static_cast<std::size_t>(t[0])], &b = positions[static_cast<std::size_t>(t[1])],
                &c = positions[static_cast<std::size_t>(t[2])];
    area += 0.5 * static_cast<double>((b - a).cross(c - a).norm());
    depth += static_cast<double>((a - camera.position).dot(camera.forward));
  }
  const double count = std::max<double>(1, static_cast<double>(mesh.triangles.size()));
  if (!(depth > 0)) return std::numeric_limits<float>::infinity();  // around the camera
  const double pixels_per_meter = 0.5 * width / (static_cast<double>(camera.half_width) * depth / count);
  return static_cast<float>(std::sqrt(area / count) * pixels_per_meter);
}

/// More lights than the shader has room for: the first ones, which a shot lists by importance.
int lamps_of(const Scene& scene) {
  return std::min(static_cast<int>(scene.area_lights.size()), kMaxPreviewLamps);
}
int suns_of(const Scene& scene) {
  return std::min(static_cast<int>(scene.suns.size()), kMaxPreviewSuns);
}

/// The sum of what the lights send, for the shaders.
std::string lights_text(const Scene& scene, const std::vector<ShadowView>& shadows) {
  std::string text = "vec3(0.0)";
  const auto add = [&](bool is_sun, int light) {
    int layer = -1;
    for (std::size_t k = 0; k < shadows.size(); ++k)
      if (shadows[k].is_sun == is_sun && shadows[k].light == light) layer = static_cast<int>(k);
    text += fmt::format(" + {}({}, {}, skin)", is_sun ? "from_sun" : "from_lamp", light, layer);
  };
  for (int k = 0; k < lamps_of(scene); ++k) add(false, k);
  for (int k = 0; k < suns_of(scene); ++k) add(true, k);
  return text;
}

/// The first lines of a fragment shader.
std::string head(ViewTransform view) {
  return fmt::format("#version 330 core\n#define VIEW {}\n", static_cast<int>(view));
}

class EglPreview : public Preview {
 public:
  EglPreview() {
    context_.make_current();
    plain_ = std::make_unique<GlProgram>(kPlainVertexShader, kPlainFragmentShader);
    overlay_ = std::make_unique<GlProgram>(kOverlayVertexShader, kOverlayFragmentShader);
    glGenVertexArrays(1, &no_array_);
    shadows_ = std::make_unique<ShadowLayers>(kMaxPreviewShadows);
    marks_ = std::make_unique<GpuMarks>();
  }
  using Preview::draw;
  DisplayImage draw(const Scene& scene, int width, int height, ViewTransform view, float exposure,
                    const PreviewStyle& style) override;
  std::string description() const override {
    context_.make_current();
    return fmt::format("{}, {}, OpenGL {}", context_.version(), reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                       reinterpret_cast<const char*>(glGetString(GL_VERSION)));
  }

 private:
  const GlProgram& program(const std::string& vertex, const std::string& fragment);
  const GlProgram& surface_program(const Scene& scene, const Ground* ground, ViewTransform view,
                                   const std::vector<ShadowView>& shadows, bool at_vertices);
  void upload(const Scene& scene, const MotionMesh& ground);
  void draw_shadows(const std::vector<ShadowView>& views) const;
  void set_common(const GlProgram& program, const Environment& gradient, float exposure) const;
  void set_lights(const GlProgram& surface, const Scene& scene) const;
  void set_shadows(const GlProgram& surface, const std::vector<ShadowView>& views) const;
  void set_ground(const GlProgram& surface, const Ground& ground, const Camera& camera) const;
  void set_appearance(const GlProgram& surface, const MotionMesh& mesh) const;
  void draw_background(const GlProgram& background, const CameraFrame& camera) const;
  void draw_edges(const Eigen::Matrix4f& clip_from_world) const;
  void draw_marks(const std::vector<OverlayVertex>& triangles) const;

  EglContext context_;
  std::map<std::string, GlProgram> programs_;  ///< by the text of their shaders
  std::unique_ptr<GlProgram> plain_, overlay_;
  std::unique_ptr<ShadowLayers> shadows_;
  std::unique_ptr<GpuMarks> marks_;
  std::unique_ptr<Canvas> canvas_;  ///< of the last picture
  std::deque<GpuMesh> bodies_;      ///< of the last scene
  std::optional<GpuMesh> ground_;
  GLuint no_array_ = 0;  ///< OpenGL draws nothing without one, even where no vertex has an attribute
};

/// Made when it is first asked for.
const GlProgram& EglPreview::program(const std::string& vertex, const std::string& fragment) {
  return programs_.try_emplace(vertex + fragment, vertex, fragment).first->second;
}

/// ground: null for bodies.
const GlProgram& EglPreview::surface_program(const Scene& scene, const Ground* ground, ViewTransform view,
                                             const std::vector<ShadowView>& shadows, bool at_vertices) {
  const bool checker = ground != nullptr && ground->checker > 0;
  const std::string begin =
      head(view) + fmt::format(
                       "#define GROUND {}\n#define CHECKER {}\n#define SHADOWS {}\n#define LIGHTS(skin) {}\n"
                       "#define AT_VERTICES {}\n#define SHADOW_BLUR {}\n",
                       ground != nullptr ? 1 : 0, checker ? 1 : 0, shadows.size(), lights_text(scene, shadows),
                       at_vertices ? 1 : 0, at_vertices ? "5.0" : "1.0");
  const std::string functions = std::string(kEnvironmentFunctions) + kDisplayFunctions + kSurfaceFunctions;
  if (at_vertices)
    return program(begin + kSurfaceAttributes + kVertexLitInputs + functions + kVertexLitMain,
                   kVertexLitFragmentShader);
  return program(begin + kSurfaceAttributes + kPixelLitVertexShader,
                 begin + kPixelLitInputs + functions + kPixelLitMain);
}

void EglPreview::upload(const Scene& scene, const MotionMesh& ground) {
  while (bodies_.size() > scene.meshes.size()) bodies_.pop_back();
  while (bodies_.size() < scene.meshes.size()) bodies_.emplace_back();
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    bodies_[b].upload(scene.meshes[b], vertex_base_colors(scene.meshes[b]));
  if (!scene.ground) return;
  if (!ground_) ground_.emplace();
  ground_->upload(ground, {});
}

void EglPreview::draw_shadows(const std::vector<ShadowView>& views) const {
  plain_->use();
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 4);
  for (std::size_t k = 0; k < views.size(); ++k) {
    shadows_->bind(static_cast<int>(k));
    glUniformMatrix4fv(plain_->at("clip_from_world"), 1, GL_FALSE, views[k].clip_from_world.data());
    for (const GpuMesh& body : bodies_) body.draw();
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void EglPreview::set_common(const GlProgram& program, const Environment& gradient, float exposure) const {
  program.use();
  program.set("zenith", Vec3f(gradient.strength * gradient.zenith));
  program.set("horizon", Vec3f(gradient.strength * gradient.horizon));
  program.set("nadir", Vec3f(gradient.strength * gradient.nadir));
  program.set("exposure_scale", std::exp2(exposure));
}

void EglPreview::set_lights(const GlProgram& surface, const Scene& scene) const {
  for (int k = 0; k < lamps_of(scene); ++k) {
    const AreaLight& lamp = scene.area_lights[static_cast<std::size_t>(k)];
    const bool sphere = lamp.shape == LampShape::Sphere;
    surface.set("lamp_center", k, lamp.center);
    surface.set("lamp_normal", k, sphere ? Vec3f(Vec3f::Zero()) : Vec3f(lamp.u.cross(lamp.v).normalized()));
    surface.set("lamp_radiance", k, lamp.radiance);
    surface.set("lamp_area", k, seen_area(lamp));
  }
  for (int k = 0; k < suns_of(scene); ++k) {
    const SunLight& sun = scene.suns[static_cast<std::size_t>(k)];
    surface.set("sun_towards", k, Vec3f(-sun.direction.normalized()));
    surface.set("sun_irradiance", k, sun.irradiance);
  }
}

void EglPreview::set_shadows(const GlProgram& surface, const std::vector<ShadowView>& views) const {
  surface.set("shadow_share", 1.0f / kShadowSize);
  for (std::size_t layer = 0; layer < views.size(); ++layer) {
    const ShadowView& view = views[layer];
    const int k = static_cast<int>(layer);
    surface.set("shadow_texel", k, view.texel);
    glUniformMatrix4fv(surface.at(fmt::format("shadow_from_world[{}]", k).c_str()), 1, GL_FALSE,
                       view.clip_from_world.data());
  }
}

void EglPreview::set_ground(const GlProgram& surface, const Ground& ground, const Camera& camera) const {
  const GroundPattern pattern(ground, camera);
  const bool plane = ground.style == GroundStyle::Plane;
  surface.set("upright_ground", plane ? 1 : 0);
  surface.set("checker", ground.checker);
  surface.set("checker_color", ground.checker_color);
  surface.set("ground_height", ground.height);
  surface.set("sweep", ground.sweep);
  surface.set("across", pattern.across());
  surface.set("along", pattern.along());
  // The plane's edge fades into the sky; a backdrop fills the picture.
  surface.set("fade_start", plane ? 0.35f * ground.size : 1e30f);
  surface.set("fade_end", plane ? 0.5f * ground.size : 2e30f);
}

void EglPreview::draw_background(const GlProgram& background, const CameraFrame& camera) const {
  background.set("forward", camera.forward);
  background.set("right", Vec3f(camera.half_width * camera.right));
  background.set("up", Vec3f(camera.half_height * camera.up));
  glBindVertexArray(no_array_);
  glDepthFunc(GL_LEQUAL);  // it lies at the far end
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthFunc(GL_LESS);
}

void EglPreview::set_appearance(const GlProgram& surface, const MotionMesh& mesh) const {
  const Appearance& look = mesh.appearance;
  surface.set("emission", look.emission);
  surface.set("roughness", look.roughness);
  surface.set("metallic", look.metallic);
  surface.set("specular", look.specular);
  surface.set("transmission", look.transmission);
  surface.set("flat_normals", mesh.times.back().normals.empty() ? 1 : 0);
}

void EglPreview::draw_edges(const Eigen::Matrix4f& clip_from_world) const {
  plain_->use();
  glUniformMatrix4fv(plain_->at("clip_from_world"), 1, GL_FALSE, clip_from_world.data());
  glUniform4f(plain_->at("tint"), 0, 0, 0, 0.2f);
  glEnable(GL_BLEND);
  glEnable(GL_POLYGON_OFFSET_LINE);
  glPolygonOffset(-1, -1);  // the lines lie in the surface
  glDepthFunc(GL_LEQUAL);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  for (const GpuMesh& body : bodies_) body.draw();
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glDepthFunc(GL_LESS);
  glDisable(GL_POLYGON_OFFSET_LINE);
  glDisable(GL_BLEND);
}

/// What is behind bodies faintly, then what is seen in full.
void EglPreview::draw_marks(const std::vector<OverlayVertex>& triangles) const {
  if (triangles.empty()) return;
  overlay_->use();
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glDepthFunc(GL_GREATER);
  overlay_->set("opacity", 0.25f);
  marks_->draw(triangles);
  glDepthFunc(GL_LEQUAL);
  overlay_->set("opacity", 1.0f);
  marks_->draw(triangles);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

DisplayImage EglPreview::draw(const Scene& scene, int width, int height, ViewTransform view, float exposure,
                              const PreviewStyle& style) {
  const CameraFrame camera = camera_frame(scene.camera, width, height);
  const MotionMesh ground = scene.ground ? ground_mesh(*scene.ground, scene.camera) : MotionMesh{};
  const std::vector<ShadowView> shadows =
      style.fast ? std::vector<ShadowView>{} : shadow_views(scene, kMaxPreviewShadows, kShadowSize);
  const int samples = style.fast ? 0 : kAntiAliasing;

  context_.make_current();
  if (!canvas_ || !canvas_->is(width, height, samples)) canvas_ = std::make_unique<Canvas>(width, height, samples);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  upload(scene, ground);
  draw_shadows(shadows);
  canvas_->bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  const Environment gradient = as_gradient(scene.environment);
  const float far = farthest(scene.meshes, ground, style.marks, camera);
  const Eigen::Matrix4f clip = clip_from_world(camera, 1e-3f * far, far);
  const auto surface = [&](const Ground* of, bool at_vertices) -> const GlProgram& {
    const GlProgram& program = surface_program(scene, of, view, shadows, at_vertices);
    set_common(program, gradient, exposure);
    set_lights(program, scene);
    set_shadows(program, shadows);
    glUniformMatrix4fv(program.at("clip_from_world"), 1, GL_FALSE, clip.data());
    program.set("eye", camera.position);
    return program;
  };
  glEnable(GL_DEPTH_TEST);
  // From near to far: what is hidden costs nothing.
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const float pixels = triangle_size(scene.meshes[b], camera, width);
    const GlProgram& skin = surface(nullptr, pixels < kVertexLitSize && !scene.meshes[b].times.back().normals.empty());
    set_appearance(skin, scene.meshes[b]);
    bodies_[b].draw();
  }
  if (scene.ground) {
    const GlProgram& floor = surface(&*scene.ground, false);
    set_ground(floor, *scene.ground, scene.camera);
    set_appearance(floor, ground);
    ground_->draw();
  }
  const GlProgram& background = program(
      kBackgroundVertexShader, head(view) + kEnvironmentFunctions + kDisplayFunctions + kBackgroundFragmentShader);
  set_common(background, gradient, exposure);
  draw_background(background, camera);
  if (style.wireframe) draw_edges(clip);
  draw_marks(overlay_triangles(style.marks, clip, camera.position, width, height));
  DisplayImage image = canvas_->read();
  if (const GLenum failure = glGetError(); failure != GL_NO_ERROR)
    throw unusable(fmt::format("OpenGL error {:#x} while drawing {} x {} pixels", failure, width, height));
  return image;
}

}  // namespace

std::unique_ptr<Preview> softreel_make_egl_preview() {
  return std::make_unique<EglPreview>();
}

}  // namespace softreel
