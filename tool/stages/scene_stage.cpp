#include "tool/stages/scene_stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "tool/stages/atomic_file.h"

namespace softreel {

namespace {

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

SceneStage::SceneStage(const ShotRun& run) : run_(run), environment_(run.shot().environment) {
  const Shot& shot = run.shot();
  if (!shot.environment_image.empty())
    environment_checksum_ = at_environment(shot, [&] { return hash_bytes(read_file(shot.environment_image)); });
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const Bounds bounds = used_bounds(run.loaded(b).surface);
    rest_bounds_.add(bounds.min);
    rest_bounds_.add(bounds.max);
  }
}

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
  return camera;
}

SkinRequest skin_request(const RenderSettings& settings) {
  return {true, settings.shutter, settings.blur_segments};
}

namespace {

std::vector<Vec3f> to_float(const std::vector<Vec3>& values) {
  std::vector<Vec3f> result;
  result.reserve(values.size());
  for (const Vec3& value : values) result.push_back(value.cast<float>());
  return result;
}

void add(KeyHasher& key, const Appearance& a) {
  key.add(a.base_color).add(a.roughness).add(a.metallic).add(a.specular).add(a.transmission).add(a.ior);
  key.add(a.absorption).add(a.emission);
  key.add(a.coat).add(a.coat_roughness).add(a.coat_ior).add(a.coat_color);
  key.add(a.sheen).add(a.sheen_roughness).add(a.sheen_color);
  key.add(a.subsurface).add(a.subsurface_radius).add(a.subsurface_scale).add(a.subsurface_anisotropy);
}

void add(KeyHasher& key, const Camera& c) {
  key.add(c.position).add(c.target).add(c.up).add(c.focal_length_mm).add(c.sensor_width_mm).add(c.f_number);
  if (c.f_number > 0) key.add(c.focus_distance);
}

}  // namespace

Camera SceneStage::camera(int frame) const {
  const RenderParams& params = run_.shot().render.params;
  return camera_at(run_.shot().camera, frame, rest_bounds_, static_cast<double>(params.width) / params.height);
}

void SceneStage::load_environment() {
  const Shot& shot = run_.shot();
  if (!shot.environment_image.empty() && !environment_.image)
    environment_.image = at_environment(shot, [&] {
      auto image = std::make_shared<const EnvironmentImage>(read_environment(shot.environment_image));
      if (hash_bytes(read_file(shot.environment_image)) != environment_checksum_)
        throw work_error(shot.environment_image + ": changed while the shot was being rendered.\n  Run again.");
      return image;
    });
}

Scene SceneStage::at(int frame, const std::vector<SkinnedBody>& bodies) {
  const Shot& shot = run_.shot();
  CHECK(bodies.size() == run_.body_count());
  load_environment();
  Scene scene;
  scene.camera = camera(frame);
  scene.area_lights = shot.area_lights;
  scene.suns = shot.suns;
  scene.environment = environment_;
  scene.ground = shot.ground;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    MotionMesh mesh;
    mesh.name = shot.bodies[b].name;
    mesh.triangles = run_.loaded(b).surface.triangles;
    mesh.appearance = shot.materials.at(shot.bodies[b].material).appearance;
    for (const SkinnedBody::Time& time : bodies[b].times)
      mesh.times.push_back({to_float(time.positions), to_float(time.normals)});
    scene.meshes.push_back(std::move(mesh));
  }
  return scene;
}

/// All but the surfaces.
void SceneStage::add_look(KeyHasher& key, const Camera& camera) const {
  const Shot& shot = run_.shot();
  add(key, camera);
  const Environment& e = shot.environment;
  key.add(e.strength).add(environment_checksum_);
  if (environment_checksum_.empty())
    key.add(e.zenith).add(e.horizon).add(e.nadir);
  else
    key.add(e.rotation);
  for (std::size_t b = 0; b < run_.body_count(); ++b) add(key, shot.materials.at(run_.settings(b).material).appearance);
  for (const AreaLight& light : shot.area_lights)
    key.add(light.center).add(light.u).add(light.v).add(light.radiance).add(light.visible);
  for (const SunLight& sun : shot.suns) key.add(sun.direction).add(sun.irradiance).add(sun.angular_diameter);
  if (const auto& ground = shot.ground) {
    key.add(ground->style).add(ground->height).add(ground->size).add(ground->sweep);
    add(key, ground->appearance);
    key.add(ground->checker).add(ground->checker_color);
  }
  key.add(shot.render.params.width).add(shot.render.params.height);
}

void SceneStage::add_tracing(KeyHasher& key) const {
  const RenderParams& params = run_.shot().render.params;
  key.add(params.samples).add(params.max_bounces).add(params.clamp);
  key.add(params.caustic_roughness).add(params.auxiliary);
}

StageKey SceneStage::trace_key(int frame) const {
  KeyHasher key("trace 2");
  add_look(key, camera(frame));
  add_tracing(key);
  return key.add(run_.surfaces_key(frame, skin_request(run_.shot().render))).key();
}

StageKey SceneStage::preview_key(int frame) const {
  KeyHasher key("preview 3");
  add_look(key, camera(frame));
  return key.add(run_.surfaces_key(frame, {true, 0, 1})).key();
}

StageKey SceneStage::content_key(const Scene& scene) const {
  KeyHasher key("picture 2");
  add_look(key, scene.camera);
  add_tracing(key);
  for (const MotionMesh& mesh : scene.meshes) {
    key.add(mesh.triangles);
    for (const MotionMesh::Time& time : mesh.times) key.add(time.positions).add(time.normals);
  }
  return key.key();
}

}  // namespace softreel
