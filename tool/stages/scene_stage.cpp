#include "tool/stages/scene_stage.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "render/image/image_io.h"
#include "tool/bodies/simulate_key.h"
#include "tool/cache/atomic_file.h"
#include "tool/stages/appearance_key.h"

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
  constexpr double kFarthest = 100;  // sizes of the scene; at 500 of them regions were 1 % off, at 200 pictures 0.04 %
  const double farthest = std::max(rest_bounds_.min.cwiseAbs().maxCoeff(), rest_bounds_.max.cwiseAbs().maxCoeff());
  const double size = rest_bounds_.diagonal();
  if (!(farthest > kFarthest * size)) return;
  run_.context().log.warn(
      fmt::format("The bodies, {:.3g} m in size, reach to {:.3g} m from the origin along an axis: shadows may lose "
                  "contact. Accepted without loss: {:.3g} m. Move bodies (body.*.translate), camera and lights nearer.",
                  size, farthest, kFarthest * size));
}

SkinRequest skin_request(const RenderSettings& settings) {
  const ChannelSet& channels = settings.params.channels;
  SkinRequest request = still_request(settings);
  request.shutter = settings.shutter;
  request.segments = settings.blur_segments;
  request.next = channels.has(PictureChannel::Motion);
  request.strain = channels.has(PictureChannel::Strain);
  return request;
}

SkinRequest still_request(const RenderSettings& settings) {
  SkinRequest request;
  request.heat = settings.heat.quantity;
  request.creases = true;
  return request;
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

void add(KeyHasher& key, const PixelWindow& window) {
  key.add(window.left).add(window.top).add(window.right).add(window.bottom);
}

}  // namespace

Camera SceneStage::camera(double frame) const {
  const RenderParams& params = run_.shot().render.params;
  return camera_at(run_.shot().camera, frame, rest_bounds_, static_cast<double>(params.width) / params.height);
}

Camera SceneStage::next_camera(int frame) const {
  const Shot& shot = run_.shot();
  const RenderParams& params = shot.render.params;
  // As ShotRun leads surfaces on.
  const bool leads_on = frame == shot.settings.last_frame && frame > first_simulated_frame(shot);
  return (leads_on ? camera_led_on : next_camera_at)(shot.camera, frame, rest_bounds_,
                                                     static_cast<double>(params.width) / params.height);
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

void SceneStage::require_looks() const {
  const ShotSettings& settings = run_.shot().settings;
  for (int frame = settings.first_frame; frame <= settings.last_frame; ++frame) look(frame);
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

double SceneStage::count_texels() const {
  const Shot& shot = run_.shot();
  const double textures = shows_heat() ? 0 : textures_.count_texels();
  if (!shows_picture(shot)) return textures;
  const auto [width, height] = at_environment(shot, [&] { return picture_size(shot.environment_image); });
  return textures + static_cast<double>(width) * height;
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
    CHECK(run_.filled(b) != nullptr);  // it was skinned
    mesh.normal_triangles = run_.filled(b)->creases.triangles;
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
  if (!shows_heat()) return;
  const HeatRange range = heat_range();
  const HeatLegend legend = heat_legend(run_.shot().render.heat.quantity, range);
  draw_heat_legend(legend, image);
  if (has_legend_letters(image.width, image.height)) return;
  std::call_once(small_legend_,
                 [&] { run_.context().log.warn(small_legend_warning(range, image.width, image.height)); });
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
  add(key, params.window);
  for (const Camera& camera : camera_motion) add(key, camera);
  const RenderSettings& render = run_.shot().render;
  if (render.shutter > 0) key.add(render.curve.opening).add(render.curve.closing);
}

StageKey SceneStage::trace_key(int frame) const {
  KeyHasher key("trace 15");
  const Look look = this->look(frame);
  add_look(key, look);
  add_tracing(key, look.camera_motion);
  if (run_.shot().render.params.channels.has(PictureChannel::Motion)) add(key, next_camera(frame));
  if (!coloring_key_.empty()) key.add(coloring_key_);
  return key.add(run_.surfaces_key(frame, skin_request(run_.shot().render))).key();
}

StageKey SceneStage::preview_key(int frame) const {
  KeyHasher key("preview 7");
  add_look(key, look(frame));
  add(key, run_.shot().render.params.window);
  if (!coloring_key_.empty()) key.add(coloring_key_);
  return key.add(run_.surfaces_key(frame, still_request(run_.shot().render))).key();
}

StageKey SceneStage::content_key(int frame, const Scene& scene) const {
  KeyHasher key("picture 8");
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
    if (!mesh.normal_triangles.empty()) key.add("creases 1").add(mesh.normal_triangles);
    for (const MotionMesh::Time& time : mesh.times) key.add(time.positions).add(time.normals);
    key.add(mesh.next_positions);
    for (const float value : mesh.strain) key.add(double{value});
    for (const float value : mesh.coloring.heat) key.add(double{value});
  }
  return key.key();
}

}  // namespace softreel
