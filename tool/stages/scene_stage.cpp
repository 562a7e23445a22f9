#include "tool/stages/scene_stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "tool/stages/appearance_key.h"
#include "tool/stages/atomic_file.h"

namespace softreel {

namespace {

/// A sky takes the place of the picture.
bool shows_picture(const Shot& shot) {
  return !shot.environment_image.empty() && !shot.sky;
}

/// Runs `work` on the environment image; its errors get the place of the field.
template <typename Work>
auto at_environment(const Shot& shot, Work work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(error.kind(),
                fmt::format("{}: environment.image: {}", to_string(shot.environment_origin), error.what()));
  }
}

}  // namespace

SceneStage::SceneStage(ShotRun& run) : run_(run), textures_(run.shot()) {
  const Shot& shot = run.shot();
  if (!shows_heat())
    for (std::size_t b = 0; b < run.body_count(); ++b) textures_.require_match(run.settings(b), run.loaded(b));
  if (shows_picture(shot))
    environment_checksum_ = at_environment(shot, [&] { return hash_bytes(read_file(shot.environment_image)); });
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const Bounds bounds = used_bounds(run.loaded(b).surface);
    rest_bounds_.add(bounds.min);
    rest_bounds_.add(bounds.max);
  }
  KeyHasher coloring("coloring 1");
  const StageKey none = coloring.key();
  add_coloring(coloring);
  if (const StageKey key = coloring.key(); key != none) coloring_key_ = key;
}

/// Rays start off a surface by a share of its coordinates, which far away is more than shadows and contacts bear.
void SceneStage::warn_far_from_origin() const {
  constexpr double kFarthest = 500;  // sizes of the scene
  const double farthest = std::max(rest_bounds_.min.cwiseAbs().maxCoeff(), rest_bounds_.max.cwiseAbs().maxCoeff());
  const double size = rest_bounds_.diagonal();
  if (!(farthest > kFarthest * size)) return;
  run_.context().log.warn(
      fmt::format("The bodies, {:.3g} m in size, reach to {:.3g} m from the origin along an axis: shadows may lose "
                  "contact. Accepted without loss: {:.3g} m. Move bodies (body.*.translate), camera and lights nearer.",
                  size, farthest, kFarthest * size));
}

namespace {

/// The picture's upright of a camera that looks straight down or up, as if it had been tilted there from the front.
Vec3f upright(const Camera& camera) {
  const Vec3f forward = (camera.target - camera.position).normalized();
  if (!(forward.cross(Vec3f::UnitY()).norm() <= 1e-3f)) return Vec3f::UnitY();
  return Vec3f(0, 0, forward.y() < 0 ? -1.0f : 1.0f);
}

}  // namespace

Camera camera_at(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect) {
  Camera camera;
  camera.focal_length_mm = static_cast<float>(settings.focal_length_mm.at(frame));
  camera.sensor_width_mm = static_cast<float>(settings.sensor_width_mm);
  camera.f_number = static_cast<float>(settings.f_number);
  if (!settings.focus_distance.keys.empty())
    camera.focus_distance = static_cast<float>(settings.focus_distance.at(frame));
  if (settings.mode == CameraMode::Place) {
    camera.position = settings.position.at(frame).cast<float>();
    camera.target = settings.target.at(frame).cast<float>();
    camera.up = upright(camera);
    return camera;
  }
  constexpr double kRadians = std::numbers::pi / 180;
  const double azimuth = settings.azimuth_deg * kRadians, elevation = settings.elevation_deg * kRadians;
  const Vec3 toward_camera(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                           std::cos(elevation) * std::cos(azimuth));
  const Vec3 right = Vec3::UnitY().cross(toward_camera).normalized(), up = toward_camera.cross(right);
  // Slopes of the view at half the picture; the margin makes them smaller.
  const double half_width = 0.5 * settings.sensor_width_mm / (camera.focal_length_mm * settings.margin);
  const double half_height = half_width / aspect;
  const Vec3 target = rest_bounds.center() + settings.shift * rest_bounds.size().y();
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p = rest_bounds.min;
    for (int k = 0; k < 3; ++k)
      if (corner >> k & 1) p[k] = rest_bounds.max[k];
    p -= rest_bounds.center();
    const double depth = p.dot(toward_camera);
    distance =
        std::max({distance, depth + std::abs(p.dot(right)) / half_width, depth + std::abs(p.dot(up)) / half_height});
  }
  camera.target = target.cast<float>();
  camera.position = (target + distance * toward_camera).cast<float>();
  if (std::abs(toward_camera.y()) > 1 - 1e-6) camera.up = up.cast<float>();
  return camera;
}

std::optional<double> last_cut(const CameraSettings& settings, double after, double until) {
  std::optional<double> cut = last_jump(settings.focal_length_mm, after, until);
  const auto add = [&](const auto& track) { cut = std::max(cut, last_jump(track, after, until)); };
  if (settings.f_number > 0) add(settings.focus_distance);
  if (settings.mode != CameraMode::Place) return cut;
  add(settings.position);
  add(settings.target);
  return cut;
}

std::vector<Camera> camera_motion_at(const CameraSettings& settings, const RenderSettings& render, double frame,
                                     const Bounds& rest_bounds, double aspect) {
  if (!(render.shutter > 0)) return {};
  std::vector<Camera> cameras;
  // The picture is the shot after a cut: a camera between the two would fly through the scene.
  const std::optional<double> cut = last_cut(settings, frame - render.shutter, frame);
  for (int k = 0; k <= render.blur_segments; ++k) {
    const double time = render.shutter * (static_cast<double>(k) / render.blur_segments - 1);
    cameras.push_back(camera_at(settings, std::max(frame + time, cut.value_or(frame + time)), rest_bounds, aspect));
  }
  const bool stands =
      std::all_of(cameras.begin(), cameras.end(), [&](const Camera& camera) { return camera == cameras.back(); });
  return stands ? std::vector<Camera>{} : cameras;
}

Camera next_camera_at(const CameraSettings& settings, double frame, const Bounds& rest_bounds, double aspect) {
  return camera_at(settings, last_cut(settings, frame, frame + 1) ? frame : frame + 1, rest_bounds, aspect);
}

SkinRequest skin_request(const RenderSettings& settings) {
  const ChannelSet& channels = settings.params.channels;
  return {true,
          settings.shutter,
          settings.blur_segments,
          channels.has(PictureChannel::Motion),
          settings.heat.quantity,
          channels.has(PictureChannel::Strain)};
}

SkinRequest still_request(const RenderSettings& settings) {
  return {true, 0, 1, false, settings.heat.quantity, false};
}

namespace {

std::vector<Vec3f> to_float(const std::vector<Vec3>& values) {
  std::vector<Vec3f> result;
  result.reserve(values.size());
  for (const Vec3& value : values) result.push_back(value.cast<float>());
  return result;
}

void add(KeyHasher& key, const Camera& c) {
  key.add(c.position).add(c.target).add(c.up).add(c.focal_length_mm).add(c.sensor_width_mm).add(c.f_number);
  if (c.f_number > 0) key.add(c.focus_distance);
}

}  // namespace

Camera SceneStage::camera(double frame) const {
  const RenderParams& params = run_.shot().render.params;
  return camera_at(run_.shot().camera, frame, rest_bounds_, static_cast<double>(params.width) / params.height);
}

Camera SceneStage::next_camera(int frame) const {
  const RenderParams& params = run_.shot().render.params;
  return next_camera_at(run_.shot().camera, frame, rest_bounds_, static_cast<double>(params.width) / params.height);
}

std::vector<Camera> SceneStage::camera_motion(int frame) const {
  const RenderSettings& render = run_.shot().render;
  return camera_motion_at(run_.shot().camera, render, frame, rest_bounds_,
                          static_cast<double>(render.params.width) / render.params.height);
}

SceneStage::Look SceneStage::look(int frame) const {
  const Shot& shot = run_.shot();
  Look look{camera(frame),
            camera_motion(frame),
            lights_at(shot, frame),
            environment_at(shot, frame),
            daylight_at(shot, frame),
            {}};
  for (std::size_t b = 0; b < run_.body_count(); ++b) look.appearances.push_back(appearance(b, frame));
  return look;
}

void SceneStage::load_images() {
  const Shot& shot = run_.shot();
  if (!shows_heat()) textures_.load();
  if (shows_picture(shot) && !environment_image_)
    environment_image_ = at_environment(shot, [&] {
      auto image = std::make_shared<const EnvironmentImage>(read_environment(shot.environment_image));
      if (hash_bytes(read_file(shot.environment_image)) != environment_checksum_)
        throw work_error(shot.environment_image + ": changed while the shot was being rendered.\n  Run again.");
      return image;
    });
}

/// Once, before the first scene: what all of them share, and what is to be said of them.
void SceneStage::start_scenes() {
  warn_far_from_origin();
  for (std::size_t b = 0; b < run_.body_count(); ++b)
    rest_positions_.push_back(std::make_shared<const std::vector<Vec3f>>(to_float(run_.loaded(b).surface.positions)));
}

Scene SceneStage::at(int frame, const std::vector<SkinnedBody>& bodies) {
  const Shot& shot = run_.shot();
  CHECK(bodies.size() == run_.body_count());
  load_images();
  Look look = this->look(frame);
  if (look.day && drawn_day_ != look.day) {
    environment_image_ = sky_image(SkyModel(*look.day));
    drawn_day_ = look.day;
  }
  if (rest_positions_.empty()) start_scenes();
  Scene scene;
  scene.camera = look.camera;
  if (shot.render.params.channels.has(PictureChannel::Motion)) scene.next_camera = next_camera(frame);
  scene.camera_motion = std::move(look.camera_motion);
  scene.shutter = shot.render.curve;
  scene.area_lights = std::move(look.lights.lamps);
  scene.suns = std::move(look.lights.suns);
  scene.environment = look.environment;
  scene.environment.image = environment_image_;
  if (look.day) scene.environment.rotation = 0;  // its sun says how it is turned
  scene.ground = shot.ground;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    MotionMesh mesh;
    mesh.name = shot.bodies[b].name;
    mesh.triangles = run_.loaded(b).surface.triangles;
    mesh.rest_positions = rest_positions_[b];
    mesh.appearance = look.appearances[b];
    mesh.material = shot.bodies[b].material;
    mesh.next_positions = to_float(bodies[b].next_positions);
    if (!shows_heat()) mesh.coloring = textures_.coloring(shot.bodies[b], run_.loaded(b));
    if (!bodies[b].heat.empty()) {
      const HeatRange range = heat_range();
      for (const double value : bodies[b].heat) mesh.coloring.heat.push_back(range.place(value));
    }
    mesh.strain.assign(bodies[b].strain.begin(), bodies[b].strain.end());
    for (const SkinnedBody::Time& time : bodies[b].times)
      mesh.times.push_back({to_float(time.positions), to_float(time.normals)});
    scene.meshes.push_back(std::move(mesh));
  }
  return scene;
}

/// Matt where it shows heat, whatever the material is, so that colours can be read.
Appearance SceneStage::appearance(std::size_t body, int frame) const {
  if (!shows_heat()) return appearance_at(run_.shot().materials.at(run_.settings(body).material), frame);
  Appearance matt;
  matt.roughness = 0.6f;
  matt.specular = 0.25f;
  return matt;
}

void SceneStage::add_coloring(KeyHasher& key) const {
  const HeatSettings& heat = run_.shot().render.heat;
  if (heat.quantity == HeatQuantity::None) {
    for (std::size_t b = 0; b < run_.body_count(); ++b)
      if (textures_.varies(run_.settings(b))) {
        key.add(static_cast<int>(b));  // bodies of one mesh may swap their materials
        textures_.add_key(key, run_.settings(b), run_.loaded(b));
      }
    return;
  }
  key.add("heat 1").add(heat.quantity);
  if (heat.range)
    key.add(heat.range->x()).add(heat.range->y());
  else
    key.add("of used vertices").add(run_.all_frames_key());
}

HeatRange SceneStage::heat_range() const {
  const HeatSettings& heat = run_.shot().render.heat;
  if (heat.range) return {heat.range->x(), heat.range->y()};
  const std::lock_guard lock(range_mutex_);
  if (!found_range_) found_range_ = find_heat_range(run_, heat.quantity);
  return *found_range_;
}

void SceneStage::draw_legend(DisplayImage& image) const {
  if (shows_heat()) draw_heat_legend(heat_legend(run_.shot().render.heat.quantity, heat_range()), image);
}

/// All but the surfaces.
void SceneStage::add_look(KeyHasher& key, const Look& look) const {
  const Shot& shot = run_.shot();
  add(key, look.camera);
  const Environment& e = look.environment;
  key.add(e.strength).add(environment_checksum_);
  if (look.day)
    key.add("sky")
        .add(look.day->elevation)
        .add(look.day->azimuth)
        .add(look.day->turbidity)
        .add(look.day->ground_albedo);
  else if (environment_checksum_.empty())
    key.add(e.zenith).add(e.horizon).add(e.nadir);
  else
    key.add(e.rotation);
  for (const Appearance& appearance : look.appearances) add(key, appearance);
  for (const AreaLight& lamp : look.lights.lamps)
    key.add(lamp.shape).add(lamp.center).add(lamp.u).add(lamp.v).add(lamp.radiance).add(lamp.visible);
  for (const SunLight& sun : look.lights.suns) key.add(sun.direction).add(sun.irradiance).add(sun.angular_diameter);
  if (const auto& ground = shot.ground) {
    key.add(ground->style).add(ground->height).add(ground->size).add(ground->sweep).add(ground->shadow_catcher);
    add(key, ground->appearance);
    key.add(ground->checker).add(ground->checker_color);
  }
  key.add(shot.render.params.width).add(shot.render.params.height);
}

void SceneStage::add_tracing(KeyHasher& key, const std::vector<Camera>& camera_motion) const {
  const RenderParams& params = run_.shot().render.params;
  key.add(params.samples).add(params.max_bounces).add(params.clamp);
  key.add(params.caustic_roughness).add(params.auxiliary);
  key.add(params.channels.bits);
  for (const BodySettings& body : run_.shot().bodies) {
    if (params.channels.has(PictureChannel::ObjectId)) key.add(body.name);
    if (params.channels.has(PictureChannel::MaterialId)) key.add(body.material);
  }
  key.add(params.noise).add(params.noise > 0 ? params.min_samples : 0).add(params.time_limit);
  const PixelWindow& window = params.window;
  key.add(window.left).add(window.top).add(window.right).add(window.bottom);
  for (const Camera& camera : camera_motion) add(key, camera);
  const RenderSettings& render = run_.shot().render;
  if (render.shutter > 0) key.add(render.curve.opening).add(render.curve.closing);
}

StageKey SceneStage::trace_key(int frame) const {
  KeyHasher key("trace 9");
  const Look look = this->look(frame);
  add_look(key, look);
  add_tracing(key, look.camera_motion);
  if (run_.shot().render.params.channels.has(PictureChannel::Motion)) add(key, next_camera(frame));
  if (!coloring_key_.empty()) key.add(coloring_key_);
  return key.add(run_.surfaces_key(frame, skin_request(run_.shot().render))).key();
}

StageKey SceneStage::preview_key(int frame) const {
  KeyHasher key("preview 6");
  add_look(key, look(frame));
  if (!coloring_key_.empty()) key.add(coloring_key_);
  return key.add(run_.surfaces_key(frame, still_request(run_.shot().render))).key();
}

StageKey SceneStage::content_key(int frame, const Scene& scene) const {
  KeyHasher key("picture 5");
  Look look = this->look(frame);
  look.camera = scene.camera;  // a turntable's is its own
  add_look(key, look);
  add_tracing(key, scene.camera_motion);
  if (scene.next_camera) add(key, *scene.next_camera);
  if (shows_heat()) {
    const HeatRange range = heat_range();
    key.add("heat 1").add(run_.shot().render.heat.quantity).add(range.low).add(range.high);
  } else if (!coloring_key_.empty()) {
    key.add(coloring_key_);
  }
  // Rays may find the edge between two triangles to be of either in trees of another shape at rest.
  for (std::size_t b = 0; b < run_.body_count(); ++b) key.add(run_.loaded(b).key);
  for (const MotionMesh& mesh : scene.meshes) {
    key.add(mesh.triangles);
    for (const MotionMesh::Time& time : mesh.times) key.add(time.positions).add(time.normals);
    key.add(mesh.next_positions);
    for (const float value : mesh.strain) key.add(double{value});
    for (const float value : mesh.coloring.heat) key.add(double{value});
  }
  return key.key();
}

}  // namespace softreel
