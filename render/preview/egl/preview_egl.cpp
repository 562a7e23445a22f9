/// The preview on EGL. The files of egl/ are the only ones that know EGL and OpenGL.
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "render/preview/depth_range.h"
#include "render/preview/egl/egl_context.h"
#include "render/preview/egl/gl_objects.h"
#include "render/preview/egl/gpu_meshes.h"
#include "render/preview/egl/gpu_sky.h"
#include "render/preview/egl/gpu_textures.h"
#include "render/preview/egl/preview_shaders.h"
#include "render/preview/egl/surface_programs.h"
#include "render/preview/lamp_shapes.h"
#include "render/preview/picture_regions.h"
#include "render/preview/preview.h"
#include "render/preview/shadow_views.h"
#include "render/scene/camera_frame.h"
#include "render/scene/ground_mesh.h"

namespace softreel {

namespace {

constexpr int kAntiAliasing = 4;     ///< samples a pixel
constexpr float kVertexLitSize = 5;  ///< pixels: smaller triangles are lit at their vertices

/// Clip coordinates: the camera's window fills the picture, depth from `near` to `far` metres.
Eigen::Matrix4f clip_from_world(const CameraFrame& camera, float near, float far) {
  Eigen::Matrix4f clip;
  clip.row(0) << (camera.right - camera.center_x * camera.forward).transpose() / camera.half_width, 0;
  clip.row(1) << (camera.up - camera.center_y * camera.forward).transpose() / camera.half_height, 0;
  clip.row(2) << camera.forward.transpose() * ((far + near) / (far - near)), -2 * far * near / (far - near);
  clip.row(3) << camera.forward.transpose(), 0;
  Eigen::Matrix4f shift = Eigen::Matrix4f::Identity();
  shift.block<3, 1>(0, 3) = -camera.position;
  return clip * shift;
}

/// Root of the area of the triangle that a point of a mesh lies in, on average, as pixels at its mean distance, face
/// on: a few large triangles count however many small ones there are.
float triangle_size(const MotionMesh& mesh, const CameraFrame& camera, int width) {
  const std::vector<Vec3f>& positions = mesh.times.back().positions;
  double area = 0, squared = 0, depth = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3f &a = positions[static_cast<std::size_t>(t[0])], &b = positions[static_cast<std::size_t>(t[1])],
                &c = positions[static_cast<std::size_t>(t[2])];
    const double own = 0.5 * static_cast<double>((b - a).cross(c - a).norm());
    area += own;
    squared += own * own;
    depth += static_cast<double>((a - camera.position).dot(camera.forward));
  }
  if (!(depth > 0)) return std::numeric_limits<float>::infinity();  // around the camera
  const double mean_depth = depth / static_cast<double>(mesh.triangles.size());
  const double pixels_per_meter = 0.5 * width / (static_cast<double>(camera.half_width) * mean_depth);
  return area > 0 ? static_cast<float>(std::sqrt(squared / area) * pixels_per_meter) : 0.0f;
}

/// Far bodies first: what is nearer is seen through over them. Distances are those of the middles of boxes.
std::vector<std::size_t> from_far_to_near(std::vector<std::size_t> bodies, const std::vector<MotionMesh>& meshes,
                                          const Vec3f& eye) {
  std::vector<float> distances(meshes.size());
  for (const std::size_t b : bodies) {
    Eigen::AlignedBox3f box;
    for (const Vec3f& p : meshes[b].times.back().positions) box.extend(p);
    distances[b] = box.isEmpty() ? 0 : (box.center() - eye).norm();
  }
  std::stable_sort(bodies.begin(), bodies.end(),
                   [&](std::size_t a, std::size_t b) { return distances[a] > distances[b]; });
  return bodies;
}

/// The camera sees no surroundings, and of the ground only the shadow on it.
bool catches_shadows(const Scene& scene) {
  return scene.ground && scene.ground->shadow_catcher;
}

/// Before nothing, what is see-through shows the surroundings, as the path tracer has it.
bool shows_behind(const Scene& scene, const MotionMesh& mesh) {
  return is_see_through(mesh.appearance) && !catches_shadows(scene);
}

/// What is drawn beside the bodies.
struct Surroundings {
  const SurfaceView& view;
  const MotionMesh& ground;  ///< empty if there is none
  PixelRect shadowed;        ///< where shadows may fall on it
  const std::vector<OverlayVertex>& lamps;
};

/// What is drawn over bodies and ground, as triangles.
struct Overlays {
  std::vector<OverlayVertex> lamps, marks;
};

/// The part of a picture that has edges: bodies, lamps and marks, or all of it where the end of a backdrop is seen.
/// That of a plane is smooth by itself.
PixelRect fine_region(const Scene& scene, const MotionMesh& ground, const Overlays& overlays,
                      const Eigen::Matrix4f& clip_from_world, const PixelRect& whole) {
  constexpr int kMargin = 2;  // pixels
  const bool ends = scene.ground && scene.ground->style == GroundStyle::Sweep;
  if (ends && may_see_rim(ground, clip_from_world)) return whole;
  SeenRegion region(whole.width(), whole.height());
  add_bodies(region, scene.meshes, clip_from_world);
  add_seen(region, overlays.lamps);
  for (const OverlayVertex& vertex : overlays.marks) region.add(vertex.clip);
  return region.rect(kMargin);
}

void draw_only_in(const PixelRect& rect) {
  glScissor(rect.left, rect.bottom, std::max(0, rect.width()), std::max(0, rect.height()));
}

class EglPreview : public Preview {
 public:
  using Preview::draw;
  DisplayImage draw(const Scene& scene, int width, int height, ViewTransform view, float exposure,
                    const PreviewStyle& style) override;
  std::string description() const override {
    context_.make_current();
    return fmt::format("{}, {}, OpenGL {}", context_.version(), reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                       reinterpret_cast<const char*>(glGetString(GL_VERSION)));
  }

 private:
  void upload(const Scene& scene, const MotionMesh& ground);
  /// Null if the surroundings are no image.
  const GpuSky* bound_sky(const Environment& environment);
  void draw_shadows(const std::vector<ShadowView>& views);
  void draw_bodies(const Scene& scene, const CameraFrame& camera, int width, SurfacePrograms& programs) const;
  void draw_glass(const Scene& scene, const CameraFrame& camera, int width, SurfacePrograms& programs,
                  const SurfaceView& view);
  void draw_surroundings(const Scene& scene, const CameraFrame& camera, const Surroundings& around,
                         const PixelRect& part, SurfacePrograms& programs);
  void draw_background(const SurfaceView& view, const CameraFrame& camera);
  void draw_edges(const Eigen::Matrix4f& clip_from_world);
  void draw_lamps(const SurfaceView& view, const std::vector<OverlayVertex>& triangles);
  void draw_marks(const std::vector<OverlayVertex>& triangles);
  const GlProgram& plain() { return programs_.of(kPlainVertexShader, kPlainFragmentShader); }

  EglContext context_;
  GlPrograms programs_;
  std::unique_ptr<ShadowLayers> shadows_;  ///< made when there is a shadow
  std::unique_ptr<GpuMarks> marks_;        ///< made when there is a lamp or a mark
  std::unique_ptr<Canvas> canvas_;         ///< of the last picture
  std::deque<GpuMesh> bodies_;             ///< of the last scene
  std::optional<GpuMesh> ground_;
  GpuTextures textures_;
  GpuSky sky_;
  GLuint no_array_ = 0;  ///< OpenGL draws nothing without one, even where no vertex has an attribute
};

void EglPreview::upload(const Scene& scene, const MotionMesh& ground) {
  while (bodies_.size() > scene.meshes.size()) bodies_.pop_back();
  while (bodies_.size() < scene.meshes.size()) bodies_.emplace_back();
  for (std::size_t b = 0; b < bodies_.size(); ++b) bodies_[b].upload(scene.meshes[b]);
  if (!scene.ground) return;
  if (!ground_) ground_.emplace();
  ground_->upload(ground);
}

const GpuSky* EglPreview::bound_sky(const Environment& environment) {
  if (!environment.image) return nullptr;
  sky_.bind(kSkyUnit, environment.image);
  return &sky_;
}

void EglPreview::draw_shadows(const std::vector<ShadowView>& views) {
  if (views.empty()) return;
  if (!shadows_) shadows_ = std::make_unique<ShadowLayers>(kMaxPreviewShadows);
  const GlProgram& depths = plain();
  depths.use();
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 4);
  for (std::size_t k = 0; k < views.size(); ++k) {
    shadows_->bind(static_cast<int>(k));
    glUniformMatrix4fv(depths.at("clip_from_world"), 1, GL_FALSE, views[k].clip_from_world.data());
    for (const GpuMesh& body : bodies_) body.draw_outside();
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
}

bool lit_at_vertices(const MotionMesh& mesh, const CameraFrame& camera, int width) {
  return may_be_lit_at_vertices(mesh) && triangle_size(mesh, camera, width) < kVertexLitSize;
}

void EglPreview::draw_bodies(const Scene& scene, const CameraFrame& camera, int width,
                             SurfacePrograms& programs) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const MotionMesh& mesh = scene.meshes[b];
    if (shows_behind(scene, mesh)) continue;
    programs.use_for_body(mesh, !bodies_[b].has_normals(), lit_at_vertices(mesh, camera, width), false);
    bodies_[b].draw();
  }
}

/// Of each body the nearest surface only, over what is there: depths first.
void EglPreview::draw_glass(const Scene& scene, const CameraFrame& camera, int width, SurfacePrograms& programs,
                            const SurfaceView& view) {
  std::vector<std::size_t> glass;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    if (shows_behind(scene, scene.meshes[b])) glass.push_back(b);
  for (const std::size_t b : from_far_to_near(std::move(glass), scene.meshes, view.eye)) {
    const MotionMesh& mesh = scene.meshes[b];
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    plain().use();
    glUniformMatrix4fv(plain().at("clip_from_world"), 1, GL_FALSE, view.clip_from_world.data());
    bodies_[b].draw();
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthFunc(GL_LEQUAL);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_SRC1_COLOR);
    programs.use_for_body(mesh, !bodies_[b].has_normals(), lit_at_vertices(mesh, camera, width), true);
    bodies_[b].draw();
    glDisable(GL_BLEND);
    glDepthFunc(GL_LESS);
  }
}

void EglPreview::draw_background(const SurfaceView& view, const CameraFrame& camera) {
  const GlProgram& background =
      programs_.of(kBackgroundVertexShader,
                   shader_head(view) + kEnvironmentFunctions + kDisplayFunctions + kBackgroundFragmentShader);
  set_surroundings(background, view);
  background.set("forward", camera.window_point(0, 0));
  background.set("right", Vec3f(camera.half_width * camera.right));
  background.set("up", Vec3f(camera.half_height * camera.up));
  if (no_array_ == 0) glGenVertexArrays(1, &no_array_);
  glBindVertexArray(no_array_);
  glDepthFunc(GL_LEQUAL);  // it lies at the far end
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthFunc(GL_LESS);
}

void EglPreview::draw_edges(const Eigen::Matrix4f& clip_from_world) {
  const GlProgram& edges = plain();
  edges.use();
  glUniformMatrix4fv(edges.at("clip_from_world"), 1, GL_FALSE, clip_from_world.data());
  glUniform4f(edges.at("tint"), 0, 0, 0, 0.2f);
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

/// Added to what is behind them, from the side to which they shine.
void EglPreview::draw_lamps(const SurfaceView& view, const std::vector<OverlayVertex>& triangles) {
  if (triangles.empty()) return;
  if (!marks_) marks_ = std::make_unique<GpuMarks>();
  const GlProgram& lamp =
      programs_.of(kOverlayVertexShader, shader_head(view) + kDisplayFunctions + kLampFragmentShader);
  lamp.use();
  lamp.set("exposure_scale", std::exp2(view.exposure));
  glDepthMask(GL_FALSE);
  glEnable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  marks_->draw(triangles);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDepthMask(GL_TRUE);
}

/// What is behind bodies faintly, then what is seen in full.
void EglPreview::draw_marks(const std::vector<OverlayVertex>& triangles) {
  if (triangles.empty()) return;
  if (!marks_) marks_ = std::make_unique<GpuMarks>();
  const GlProgram& overlay = programs_.of(kOverlayVertexShader, kOverlayFragmentShader);
  overlay.use();
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glDepthFunc(GL_GREATER);
  overlay.set("opacity", 0.25f);
  marks_->draw(triangles);
  glDepthFunc(GL_LEQUAL);
  overlay.set("opacity", 1.0f);
  marks_->draw(triangles);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

/// Ground, background and lamps in a part of the picture.
void EglPreview::draw_surroundings(const Scene& scene, const CameraFrame& camera, const Surroundings& around,
                                   const PixelRect& part, SurfacePrograms& programs) {
  const auto draw_ground = [&](const std::vector<PixelRect>& parts, bool in_shadow) {
    if (parts.empty()) return;
    programs.use_for_ground(*scene.ground, around.ground, in_shadow);
    // Soles that lie in the floor are not seen through it.
    const bool from_below = camera.position.y() < scene.ground->height;
    if (from_below) glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-1, -16);
    for (const PixelRect& rect : parts) {
      draw_only_in(rect);
      ground_->draw();
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
  };
  if (scene.ground) {
    const PixelRect shadowed = common(part, around.shadowed);
    draw_ground(shadowed.empty() ? std::vector<PixelRect>{} : std::vector<PixelRect>{shadowed}, true);
    draw_ground(without(part, around.shadowed), false);
  }
  draw_only_in(part);
  if (!catches_shadows(scene)) draw_background(around.view, camera);
  draw_lamps(around.view, around.lamps);
}

DisplayImage EglPreview::draw(const Scene& scene, int width, int height, ViewTransform view, float exposure,
                              const PreviewStyle& style) {
  const CameraFrame camera = seen_through(style.window, camera_frame(scene.camera, width, height), width, height);
  const int picture_height = height;
  if (style.window != PixelWindow{}) width = style.window.width(), height = style.window.height();
  const MotionMesh ground = scene.ground ? ground_mesh(*scene.ground, scene.camera, 1) : MotionMesh{};
  const std::vector<LampCorner> lamps = visible_lamps(scene.area_lights);
  const DepthRange depths = depth_range(scene.meshes, ground, style.marks, lamps, camera);
  const Eigen::Matrix4f clip = clip_from_world(camera, depths.near, depths.far);
  SurfaceView seen{view, exposure, scene.environment, {}, clip, camera.position};
  seen.pixel_angle = 2 * camera.half_width / static_cast<float>(width);
  if (!style.fast) seen.shadows = shadow_views(scene, kMaxPreviewShadows, kShadowSize);
  const Overlays overlays{lamp_triangles(lamps, clip),
                          overlay_triangles(style.marks, clip, camera.position, width, height, picture_height)};
  const PixelRect whole{0, 0, width, height};
  const PixelRect fine = style.fast ? whole : fine_region(scene, ground, overlays, clip, whole);
  const Surroundings around{seen, ground,
                            scene.ground ? shadow_region(ground, seen.shadows, clip, width, height) : PixelRect{},
                            overlays.lamps};
  const GLbitfield cleared = GL_DEPTH_BUFFER_BIT | (catches_shadows(scene) ? GL_COLOR_BUFFER_BIT : 0);
  const int samples = style.fast ? 0 : kAntiAliasing;

  context_.make_current();
  if (!canvas_ || !canvas_->is(width, height, samples)) canvas_ = std::make_unique<Canvas>(width, height, samples);
  seen.sky = bound_sky(scene.environment);
  upload(scene, ground);
  draw_shadows(seen.shadows);
  SurfacePrograms programs(scene, seen, programs_, textures_);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_SCISSOR_TEST);
  if (samples > 0) canvas_->bind_coarse();
  for (const PixelRect& part : without(whole, fine)) {
    draw_only_in(part);
    glClear(cleared);
    draw_surroundings(scene, camera, around, part, programs);
  }
  canvas_->bind_fine();
  draw_only_in(fine);
  glClear(cleared);
  // From near to far: what is hidden costs nothing. Then what is seen through, from far to near.
  draw_bodies(scene, camera, width, programs);
  draw_surroundings(scene, camera, around, fine, programs);
  draw_glass(scene, camera, width, programs, seen);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  if (style.wireframe) draw_edges(clip);
  draw_marks(overlays.marks);
  glDisable(GL_SCISSOR_TEST);
  DisplayImage image = canvas_->read(catches_shadows(scene), fine);
  if (const GLenum failure = glGetError(); failure != GL_NO_ERROR)
    throw unusable(fmt::format("OpenGL error {:#x} while drawing {} x {} pixels", failure, width, height));
  return image;
}

}  // namespace

std::unique_ptr<Preview> softreel_make_egl_preview() {
  return std::make_unique<EglPreview>();
}

}  // namespace softreel
