#include "tool/report/studio.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "core/base/error.h"
#include "render/image/image_io.h"
#include "render/pathtrace/path_tracer.h"
#include "render/pathtrace/rays/ray_scene.h"
#include "tool/cache/atomic_file.h"

namespace softreel {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr float kFocalLengthMm = 70;  ///< long, for little perspective
constexpr float kSensorWidthMm = 36;
constexpr double kMargin = 1.14;  ///< picture over what is in it
constexpr int kSamples = 16;

/// Unit; from what is shown to the camera: `facing`, turned to the side by 36 degrees and raised; what faces up or
/// down is looked at from 56 degrees above or 47 below.
Vec3 toward_camera(const Vec3& facing) {
  const Vec3 n = facing.normalized();
  const double raised = std::asin(std::clamp(n.y(), -1.0, 1.0));
  const double azimuth = (std::abs(n.y()) < 0.999 ? std::atan2(n.x(), n.z()) : 0.0) + 36 * kDegree;
  const double elevation = 16 * kDegree + (raised > 0 ? 0.45 : 0.7) * raised;
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

/// Largest slopes of the points as seen along an axis, towards either side: a pinhole at `shift` across and `distance`
/// away sees them all within `slope` if (plus + minus) / 2 = distance * slope, shift = (plus - minus) / 2.
struct Extent {
  double plus = -1e300, minus = -1e300;
  void add(double across, double depth, double slope) {
    plus = std::max(plus, across + depth * slope);
    minus = std::max(minus, -across + depth * slope);
  }
  double shift() const { return 0.5 * (plus - minus); }
  double distance(double slope) const { return 0.5 * (plus + minus) / slope; }
};

/// The nearest camera in that direction which has all points in the picture, with the margin.
Camera framing_camera(const std::vector<MotionMesh>& meshes, const Vec3& toward, const PictureSize& size) {
  const Vec3 right = Vec3::UnitY().cross(toward).normalized(), up = toward.cross(right);
  const double slope_x = 0.5 * double{kSensorWidthMm} / (double{kFocalLengthMm} * kMargin);
  const double slope_y = slope_x * size.height / size.width;
  Extent x, y;
  for (const MotionMesh& mesh : meshes)
    for (const Vec3f& position : mesh.times.front().positions) {
      const Vec3 p = position.cast<double>();
      x.add(p.dot(right), p.dot(toward), slope_x);
      y.add(p.dot(up), p.dot(toward), slope_y);
    }
  const Vec3 target = x.shift() * right + y.shift() * up;
  Camera camera;
  camera.focal_length_mm = kFocalLengthMm;
  camera.sensor_width_mm = kSensorWidthMm;
  camera.target = target.cast<float>();
  camera.position = (target + std::max(x.distance(slope_x), y.distance(slope_y)) * toward).cast<float>();
  return camera;
}

/// An even sky, and a wide sun from the left of the camera. The open ground is exactly as bright as the sky, so that
/// there is no horizon. Both are distant: the open ground is free of noise.
constexpr float kSky = 0.88f, kGroundAlbedo = 0.6f;
constexpr double kSunAzimuth = -40 * kDegree, kSunElevation = 50 * kDegree;

/// On the camera's side of the ground, and moved with the camera, so that every view is lit alike.
SunLight studio_sun(const Vec3& toward) {
  const double azimuth = std::atan2(toward.x(), toward.z()) + kSunAzimuth;
  const double height = toward.y() > 0 ? std::sin(kSunElevation) : -std::sin(kSunElevation);
  const Vec3 towards(std::cos(kSunElevation) * std::sin(azimuth), height, std::cos(kSunElevation) * std::cos(azimuth));
  // kSky = kGroundAlbedo / pi (pi kSky + irradiance sin(elevation))
  const double irradiance = std::numbers::pi * double{kSky} * (1 / double{kGroundAlbedo} - 1) / std::sin(kSunElevation);
  SunLight sun;
  sun.direction = -towards.cast<float>();
  sun.irradiance = Vec3f::Constant(static_cast<float>(irradiance));
  sun.angular_diameter = 0.5f;
  return sun;
}

Scene studio_scene(std::vector<MotionMesh> meshes, const Vec3& toward, const PictureSize& size) {
  Scene scene;
  scene.camera = framing_camera(meshes, toward, size);
  scene.meshes = std::move(meshes);
  scene.suns = {studio_sun(toward)};
  scene.environment.zenith = scene.environment.horizon = scene.environment.nadir = Vec3f::Constant(kSky);
  if (toward.y() <= 0) return scene;  // seen from below: no ground in between
  Ground ground;
  ground.size = 400;
  ground.appearance.base_color = Vec3f::Constant(kGroundAlbedo);
  ground.appearance.specular = 0;
  scene.ground = ground;
  return scene;
}

}  // namespace

PictureSize parse_picture_size(const std::string& text) {
  PictureSize size;
  const char* const end = text.data() + text.size();
  const auto [stopped, code] = std::from_chars(text.data(), end, size.width);
  const bool has_width = code == std::errc{} && stopped != end && *stopped == 'x';
  const auto [last, error] = has_width ? std::from_chars(stopped + 1, end, size.height)
                                       : std::from_chars_result{stopped, std::errc::invalid_argument};
  const auto fits = [](int pixels) { return pixels >= 16 && pixels <= 8192; };
  if (error != std::errc{} || last != end || !fits(size.width) || !fits(size.height))
    throw input_error(fmt::format(
        "--picture-size {}: this is no size.\n  Accepted: WIDTHxHEIGHT, 16 to 8192 pixels each. Use 1600x1200.", text));
  return size;
}

void check_picture(const PictureOptions& options) {
  if (options.path.empty()) return;
  const std::string extension = std::filesystem::path(options.path).extension().string();
  if (extension != ".png")
    throw input_error(
        fmt::format("--picture {}: the format \"{}\" is not known.\n  Accepted: .png. Name a file that "
                    "ends so.",
                    options.path, extension));
  parse_picture_size(options.size);
  make_ray_scene(1);
}

StudioPlace::StudioPlace(const Bounds& box)
    : origin(box.center().x(), box.min.y(), box.center().z()), scale(1 / box.diagonal()) {}

MotionMesh studio_mesh(const char* name, const Vec3f& color, const Vec3f& line_color, float line_width) {
  MotionMesh mesh;
  mesh.name = name;
  mesh.times.resize(1);
  mesh.appearance.base_color = color;
  mesh.appearance.specular = 0;
  if (line_width > 0) {
    mesh.lines.emplace();
    mesh.lines->width = line_width;
    mesh.lines->color = line_color;
  }
  return mesh;
}

void add_triangle(MotionMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  std::vector<Vec3f>& positions = mesh.times.front().positions;
  const auto first = static_cast<Index>(positions.size());
  positions.insert(positions.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

void draw_in_studio(std::vector<MotionMesh> meshes, const Vec3& facing, const PictureOptions& options,
                    const Threads& threads) {
  const PictureSize size = parse_picture_size(options.size);
  std::erase_if(meshes, [](const MotionMesh& mesh) { return mesh.triangles.empty(); });
  for (MotionMesh& mesh : meshes)
    if (mesh.lines) mesh.lines->width *= static_cast<float>(size.width) / 1600;
  RenderParams params;
  params.width = size.width;
  params.height = size.height;
  params.samples = kSamples;
  params.max_bounces = 3;
  StageTimes times;
  const Image image =
      PathTracer(threads, times).render(studio_scene(std::move(meshes), toward_camera(facing), size), params);
  write_file(options.path, encode_png(to_display(image, ViewTransform::Filmic, 0)));
}

}  // namespace softreel
