#include "render/pathtrace/path_tracer.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "render/pathtrace/path_integrator.h"
#include "render/pathtrace/picture_hash.h"
#include "render/scene/camera_frame.h"

namespace softreel {

namespace {

constexpr int kTile = 16;  ///< pixels, edge of the unit of work

/// Channels in the order in which a pixel's values are stored.
constexpr std::array<const char*, 10> kChannelNames = {"R",        "G",        "B",        "albedo.R", "albedo.G",
                                                       "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"};

void check_meshes(const Scene& scene) {
  for (const MotionMesh& mesh : scene.meshes) {
    CHECK(!mesh.times.empty());
    if (mesh.lines && !mesh.lines->drawn.empty()) CHECK(mesh.lines->drawn.size() == mesh.triangles.size());
    for (const MotionMesh::Time& time : mesh.times) {
      CHECK(time.positions.size() == mesh.times.front().positions.size());
      if (!time.normals.empty()) CHECK(time.normals.size() == time.positions.size());
      CHECK(time.normals.empty() == mesh.times.front().normals.empty());
    }
  }
}

Image empty_image(const RenderParams& params) {
  Image image{params.width, params.height, {}};
  const std::size_t channels = params.auxiliary ? kChannelNames.size() : 3;
  const auto pixels = static_cast<std::size_t>(params.width) * static_cast<std::size_t>(params.height);
  for (std::size_t c = 0; c < channels; ++c) image.channels.push_back({kChannelNames[c], std::vector<float>(pixels)});
  return image;
}

/// One picture in the making.
class Frame {
 public:
  Frame(const Scene& scene, const RenderParams& params, const Picture& picture, Image& image)
      : params_(params),
        picture_(picture),
        image_(image),
        camera_(camera_frame(scene.camera, params.width, params.height)),
        hash_(picture_hash(scene)) {}

  int tiles() const { return tiles_across() * ((params_.height + kTile - 1) / kTile); }

  void render_tile(int tile) const {
    const int x0 = tile % tiles_across() * kTile, y0 = tile / tiles_across() * kTile;
    for (int y = y0; y < std::min(y0 + kTile, params_.height); ++y)
      for (int x = x0; x < std::min(x0 + kTile, params_.width); ++x) render_pixel(x, y);
  }

 private:
  int tiles_across() const { return (params_.width + kTile - 1) / kTile; }

  void render_pixel(int x, int y) const {
    const Sampler sampler(hash_, x, y);
    std::array<double, kChannelNames.size()> sums{};
    int hits = 0;
    for (int s = 0; s < params_.samples; ++s) {
      PathIntegrator path(picture_, sampler, static_cast<std::uint32_t>(s));
      const Vec3f radiance = path.trace(camera_ray(sampler, static_cast<std::uint32_t>(s), x, y));
      for (int c = 0; c < 3; ++c) sums[static_cast<std::size_t>(c)] += static_cast<double>(radiance[c]);
      if (params_.auxiliary) hits += add_auxiliary(path.first_hit(), sums);
    }
    store(x, y, sums, hits);
  }

  static int add_auxiliary(const FirstHit& hit, std::array<double, kChannelNames.size()>& sums) {
    for (int c = 0; c < 3; ++c) {
      sums[static_cast<std::size_t>(3 + c)] += static_cast<double>(hit.albedo[c]);
      sums[static_cast<std::size_t>(6 + c)] += static_cast<double>(hit.normal[c]);
    }
    sums[9] += static_cast<double>(hit.distance);
    return hit.distance > 0 ? 1 : 0;
  }

  /// Means over the samples; of the depth, over those that hit something.
  void store(int x, int y, const std::array<double, kChannelNames.size()>& sums, int hits) const {
    const auto pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(params_.width) + static_cast<std::size_t>(x);
    for (std::size_t c = 0; c < image_.channels.size(); ++c) {
      const int count = c == 9 ? std::max(1, hits) : params_.samples;
      image_.channels[c].pixels[pixel] = static_cast<float>(sums[c] / count);
    }
  }

  Ray camera_ray(const Sampler& sampler, std::uint32_t sample, int x, int y) const {
    const SampleBlock u = sampler.numbers(sample, 0);
    const float across = 2 * (static_cast<float>(x) + u[0]) / static_cast<float>(params_.width) - 1;
    const float up = 1 - 2 * (static_cast<float>(y) + u[1]) / static_cast<float>(params_.height);
    Ray ray;
    ray.origin = camera_.position;
    Vec3f towards = camera_.window_point(across, up);
    if (camera_.lens_radius > 0) {
      const Vec2f lens = camera_.lens_radius * concentric_disk(Vec2f(u[2], u[3]));
      const Vec3f shift = lens.x() * camera_.right + lens.y() * camera_.up;
      ray.origin += shift;
      towards = camera_.focus_distance * towards - shift;
    }
    ray.direction = towards.normalized();
    ray.time = u[4];
    return ray;
  }

  const RenderParams& params_;
  const Picture& picture_;
  Image& image_;
  CameraFrame camera_;
  std::uint64_t hash_;
};

/// The material twice: as it is, and as it is seen by way of a wide scattering.
void add_bsdfs(Picture& picture, const Appearance& appearance, float least_roughness) {
  picture.bsdfs.emplace_back(appearance);
  Appearance blurred = appearance;
  blurred.roughness = std::max(appearance.roughness, least_roughness);
  blurred.coat_roughness = std::max(appearance.coat_roughness, least_roughness);
  const bool same_coat = appearance.coat <= 0 || blurred.coat_roughness == appearance.coat_roughness;
  if (blurred.roughness == appearance.roughness && same_coat)
    picture.blurred.push_back(picture.bsdfs.back());
  else
    picture.blurred.emplace_back(blurred);
}

std::optional<Bsdf> line_bsdf(const MotionMesh& mesh) {
  if (!mesh.lines) return std::nullopt;
  Appearance matt;
  matt.base_color = mesh.lines->color;
  matt.specular = 0;
  return Bsdf(matt);
}

/// Meshes and materials of the scene; the ground comes last.
Picture make_picture(const Scene& scene, const RenderParams& params, const MotionMesh& ground) {
  Picture picture;
  picture.max_bounces = params.max_bounces;
  picture.clamp = params.clamp;
  picture.direct_light = params.direct_light;
  for (const MotionMesh& mesh : scene.meshes) picture.meshes.push_back(&mesh);
  if (scene.ground) picture.meshes.push_back(&ground);
  for (const MotionMesh* mesh : picture.meshes) {
    add_bsdfs(picture, mesh->appearance, params.caustic_roughness);
    picture.lines.push_back(line_bsdf(*mesh));
  }
  picture.pixel =
      2 * camera_frame(scene.camera, params.width, params.height).half_width / static_cast<float>(params.width);
  if (scene.ground && scene.ground->checker > 0) {
    picture.pattern.emplace(*scene.ground, scene.camera);
    Appearance second = scene.ground->appearance;
    second.base_color = scene.ground->checker_color;
    add_bsdfs(picture, second, params.caustic_roughness);
  }
  return picture;
}

}  // namespace

struct PathTracer::Parts {
  Parts(const Threads& run_on, StageTimes& stages)
      : threads(run_on), times(stages), rays(make_ray_scene(run_on.count())) {}
  const Threads& threads;
  StageTimes& times;
  std::unique_ptr<RayScene> rays;
};

PathTracer::PathTracer(const Threads& threads, StageTimes& times) : parts_(std::make_unique<Parts>(threads, times)) {}
PathTracer::~PathTracer() = default;

Image PathTracer::render(const Scene& scene, const RenderParams& params, const std::function<bool()>& cancelled) {
  CHECK(params.samples >= 1);
  CHECK(params.samples <= 1 << 20);
  CHECK(params.max_bounces >= 0);
  CHECK(params.clamp >= 0);
  CHECK(params.caustic_roughness >= 0);
  check_meshes(scene);
  const MotionMesh ground = scene.ground ? ground_mesh(*scene.ground, scene.camera) : MotionMesh{};
  Picture picture = make_picture(scene, params, ground);
  const LightSet lights(scene);
  picture.lights = &lights;
  picture.rays = parts_->rays.get();
  {
    const ScopedStage stage(parts_->times, "render/build");
    parts_->threads.run([&] { parts_->rays->build(picture.meshes); });
  }
  const ScopedStage stage(parts_->times, "render/trace");
  Image image = empty_image(params);
  const Frame frame(scene, params, picture, image);
  parts_->threads.for_chunks(frame.tiles(), 1, [&](std::int64_t begin, std::int64_t) {
    if (cancelled && cancelled())
      throw Error(ErrorKind::Interrupt, "Rendering was interrupted; the unfinished picture is dropped.");
    frame.render_tile(static_cast<int>(begin));
  });
  return image;
}

}  // namespace softreel
