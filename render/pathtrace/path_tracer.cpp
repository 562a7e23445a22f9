#include "render/pathtrace/path_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "render/pathtrace/adaptive_sampling.h"
#include "render/pathtrace/camera_rays.h"
#include "render/pathtrace/path_integrator.h"
#include "render/pathtrace/picture_hash.h"
#include "render/pathtrace/pixel_sums.h"
#include "render/scene/camera_frame.h"

namespace softreel {

namespace {

constexpr int kTile = 16;  ///< pixels, edge of the unit of work

/// Channels in the order in which a pixel's values are stored.
constexpr std::array<const char*, kPixelValues> kChannelNames = {
    "R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"};

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

/// What of the picture is computed.
PixelWindow window_of(const RenderParams& params) {
  return params.window == PixelWindow{} ? PixelWindow{0, 0, params.width, params.height} : params.window;
}

bool has_passes(const RenderParams& params) {
  return params.noise > 0 || params.time_limit > 0;
}

Image empty_image(const RenderParams& params, bool catches_shadows) {
  const PixelWindow window = window_of(params);
  Image image{window.width(), window.height(), {}};
  if (params.window != PixelWindow{}) {
    image.left = window.left;
    image.top = window.top;
    image.full_width = params.width;
    image.full_height = params.height;
  }
  const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const auto add = [&](const char* name) { image.channels.push_back({name, std::vector<float>(pixels)}); };
  const std::size_t values = params.auxiliary ? kChannelNames.size() : 3;
  for (std::size_t c = 0; c < values; ++c) add(kChannelNames[c]);
  if (catches_shadows) add("A");
  if (has_passes(params)) add("samples");
  return image;
}

/// One picture in the making.
class Frame {
 public:
  Frame(const Scene& scene, const RenderParams& params, const Picture& picture, Image& image)
      : params_(params),
        picture_(picture),
        image_(image),
        window_(window_of(params)),
        rays_(scene, params.width, params.height),
        hash_(picture_hash(scene)) {}

  int tiles() const { return tiles_across() * ((image_.height + kTile - 1) / kTile); }

  /// All of the picture's samples at once, so that no pixel's sums have to be kept.
  void render_tile(int tile) const {
    for_pixels(tile, [&](int x, int y) {
      PixelSums sums;
      add_samples(x, y, params_.samples, sums);
      store(place(x, y), sums);
    });
  }

  /// One pass: up to `samples` a pixel where `wanted` says so.
  void render_tile(int tile, int samples, const std::vector<std::uint8_t>& wanted, std::vector<PixelSums>& all) const {
    for_pixels(tile, [&](int x, int y) {
      const std::size_t pixel = place(x, y);
      if (wanted[pixel] != 0) add_samples(x, y, samples, all[pixel]);
    });
  }

  /// Means over the samples; of the depth, over those that hit something.
  void store(std::size_t pixel, const PixelSums& sums) const {
    std::size_t c = 0;
    for (; c < image_.channels.size() && c < kPixelValues && image_.channels[c].name == kChannelNames[c]; ++c) {
      const int count = c == 9 ? std::max(1, sums.hits) : sums.samples;
      image_.channels[c].pixels[pixel] = static_cast<float>(sums.values[c] / count);
    }
    if (picture_.catches_shadows) image_.channels[c++].pixels[pixel] = static_cast<float>(sums.alpha());
    if (has_passes(params_)) image_.channels[c].pixels[pixel] = static_cast<float>(sums.samples);
  }

 private:
  int tiles_across() const { return (image_.width + kTile - 1) / kTile; }
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x);
  }

  template <typename Visit>
  void for_pixels(int tile, const Visit& visit) const {
    const int x0 = tile % tiles_across() * kTile, y0 = tile / tiles_across() * kTile;
    for (int y = y0; y < std::min(y0 + kTile, image_.height); ++y)
      for (int x = x0; x < std::min(x0 + kTile, image_.width); ++x) visit(x, y);
  }

  /// Samples are keyed by the place in the whole picture: a crop has the bits of the picture that it is cut from.
  void add_samples(int x, int y, int up_to, PixelSums& sums) const {
    const int at_x = window_.left + x, at_y = window_.top + y;
    const Sampler sampler(hash_, at_x, at_y);
    PixelSums before;
    while (sums.samples < up_to) {
      const auto s = static_cast<std::uint32_t>(sums.samples);
      if (s % kBatch == 0) before = sums;
      PathIntegrator path(picture_, sampler, s);
      const Vec3f radiance = path.trace(rays_.ray(at_x, at_y, sampler.numbers(s, 0)));
      sums.add(radiance, path.first_hit());
      if (sums.samples % kBatch == 0) sums.close_batch(before);
    }
  }

  const RenderParams& params_;
  const Picture& picture_;
  Image& image_;
  PixelWindow window_;
  CameraRays rays_;
  std::uint64_t hash_;
};

/// Passes over the picture until it is clean enough, has all its samples, or time is up.
class Passes {
 public:
  Passes(const RenderParams& params, const Frame& frame, const Image& image)
      : params_(params), frame_(frame), width_(image.width), height_(image.height) {
    const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    sums_.resize(pixels);
    wanted_.assign(pixels, 1);
  }

  /// run_tiles(visit) calls visit(tile) for all tiles of the frame.
  template <typename RunTiles>
  void run(const RunTiles& run_tiles) {
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    int samples = std::min(first_pass(), params_.samples);
    double before = 0;
    for (;;) {
      run_tiles([&](int tile) { frame_.render_tile(tile, samples, wanted_, sums_); });
      const double now = seconds();
      const int next = samples_after_pass(samples, step(), params_.samples);
      if (next == samples || !is_noisy()) break;
      // Half as much again as the last pass: passes grow, and noisy pixels are slow ones.
      if (params_.time_limit > 0 && now + 1.5 * (now - before) > params_.time_limit) break;
      before = now;
      samples = next;
    }
    for (std::size_t k = 0; k < sums_.size(); ++k) frame_.store(k, sums_[k]);
  }

 private:
  int first_pass() const { return params_.noise > 0 ? params_.min_samples : 1; }
  int step() const { return params_.noise > 0 ? kBatch : 1; }
  bool is_noisy() {
    if (!(params_.noise > 0)) return true;
    wanted_ = noisy_pixels(sums_, width_, height_, static_cast<double>(params_.noise));
    return std::find(wanted_.begin(), wanted_.end(), 1) != wanted_.end();
  }

  const RenderParams& params_;
  const Frame& frame_;
  int width_, height_;
  std::vector<PixelSums> sums_;
  std::vector<std::uint8_t> wanted_;
};

/// The material twice: as it is, and as it is seen by way of a wide scattering.
void add_bsdfs(Picture& picture, const Appearance& appearance, float least_roughness) {
  picture.bsdfs.emplace_back(appearance);
  Appearance blurred = appearance;
  blurred.roughness = std::max(appearance.roughness, least_roughness);
  if (blurred.roughness == appearance.roughness)
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
  for (const MotionMesh& mesh : scene.meshes) picture.meshes.push_back(&mesh);
  if (scene.ground) picture.meshes.push_back(&ground);
  picture.catches_shadows = scene.ground && scene.ground->shadow_catcher;
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
  Parts(const Threads& run_on, StageTimes& stages, std::unique_ptr<RayScene> trees)
      : threads(run_on), times(stages), rays(std::move(trees)) {}
  const Threads& threads;
  StageTimes& times;
  std::unique_ptr<RayScene> rays;
};

PathTracer::PathTracer(const Threads& threads, StageTimes& times)
    : PathTracer(threads, times, make_ray_scene(threads.count())) {}
PathTracer::PathTracer(const Threads& threads, StageTimes& times, std::unique_ptr<RayScene> rays)
    : parts_(std::make_unique<Parts>(threads, times, std::move(rays))) {}
PathTracer::~PathTracer() = default;

Image PathTracer::render(const Scene& scene, const RenderParams& params, const std::function<bool()>& cancelled) {
  CHECK(params.samples >= 1);
  CHECK(params.samples <= 1 << 20);
  CHECK(params.max_bounces >= 0);
  CHECK(params.clamp >= 0);
  CHECK(params.caustic_roughness >= 0);
  CHECK(params.noise >= 0);
  CHECK(params.min_samples >= 2 * kBatch);
  CHECK(params.min_samples % kBatch == 0);
  CHECK(params.time_limit >= 0);
  CHECK(window_of(params).width() > 0);
  CHECK(window_of(params).height() > 0);
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
  Image image = empty_image(params, picture.catches_shadows);
  const Frame frame(scene, params, picture, image);
  const auto run_tiles = [&](const auto& visit) {
    parts_->threads.for_chunks(frame.tiles(), 1, [&](std::int64_t begin, std::int64_t) {
      if (cancelled && cancelled())
        throw Error(ErrorKind::Interrupt, "Rendering was interrupted; the unfinished picture is dropped.");
      visit(static_cast<int>(begin));
    });
  };
  if (has_passes(params))
    Passes(params, frame, image).run(run_tiles);
  else
    run_tiles([&](int tile) { frame.render_tile(tile); });
  return image;
}

}  // namespace softreel
