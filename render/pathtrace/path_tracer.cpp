#include "render/pathtrace/path_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include <fmt/format.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "render/pathtrace/adaptive_sampling.h"
#include "render/pathtrace/materials/albedo_cache.h"
#include "render/pathtrace/picture_hash.h"
#include "render/pathtrace/pixel_sampling.h"
#include "render/pathtrace/rays/camera_rays.h"
#include "render/scene/camera_frame.h"

namespace softreel {

namespace {

constexpr int kTile = 16;  ///< pixels, edge of the unit of work

/// The colour's planes; the other channels follow.
constexpr std::array<const char*, 3> kColorNames = {"R", "G", "B"};

void check_meshes(const Scene& scene) {
  for (const MotionMesh& mesh : scene.meshes) {
    CHECK(!mesh.times.empty());
    if (mesh.lines && !mesh.lines->drawn.empty()) CHECK(mesh.lines->drawn.size() == mesh.triangles.size());
    if (!mesh.normal_triangles.empty()) CHECK(mesh.normal_triangles.size() == mesh.triangles.size());
    const MotionMesh::Time& first = mesh.times.front();
    const std::size_t normals = mesh.normal_triangles.empty() ? first.positions.size() : first.normals.size();
    for (const MotionMesh::Time& time : mesh.times) {
      CHECK(time.positions.size() == first.positions.size());
      if (!time.normals.empty()) CHECK(time.normals.size() == normals);
      CHECK(time.normals.empty() == first.normals.empty());
    }
    if (mesh.rest_positions) CHECK(mesh.rest_positions->size() == first.positions.size());
    for (const std::size_t count : {mesh.next_positions.size(), mesh.strain.size()})
      if (count > 0) CHECK(count == first.positions.size());
  }
}

/// What of the picture is computed.
PixelWindow window_of(const RenderParams& params) {
  return params.window == PixelWindow{} ? PixelWindow{0, 0, params.width, params.height} : params.window;
}

Image empty_image(const RenderParams& params, const ChannelLayout& channels, bool catches_shadows) {
  const PixelWindow window = window_of(params);
  Image image{window.width(), window.height(), {}};
  if (params.window != PixelWindow{}) {
    image.left = window.left;
    image.top = window.top;
    image.full_width = params.width;
    image.full_height = params.height;
  }
  const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  for (const char* name : kColorNames) image.channels.push_back({name, std::vector<float>(pixels)});
  if (catches_shadows) image.channels.push_back({"A", std::vector<float>(pixels)});
  channels.add_planes(image);
  return image;
}

/// One picture in the making.
class Frame {
 public:
  Frame(const Scene& scene, const RenderParams& params, const Picture& picture, const ChannelLayout& channels,
        Image& image)
      : params_(params),
        picture_(picture),
        channels_(channels),
        image_(image),
        window_(window_of(params)),
        rays_(scene, params.width, params.height),
        hash_(picture_hash(scene)) {}

  int tiles() const { return tiles_across() * ((image_.height + kTile - 1) / kTile); }

  /// All of the picture's samples at once, so that no pixel's sums have to be kept.
  void render_tile(int tile) const {
    for_rows(tile, [&](PixelSampling& sampling, int x0, int x1, int y) {
      std::array<PixelSums, kTile> sums;
      std::vector<PixelChannels> gathered;
      if (channels_.gathers()) gathered.assign(kTile, PixelChannels(channels_));
      sample_row(sampling, x0, x1, y, params_.samples, [&](int x) {
        const auto k = static_cast<std::size_t>(x - x0);
        return SampledPixel{0, 0, &sums[k], gathered.empty() ? nullptr : &gathered[k]};
      });
      for (int x = x0; x < x1; ++x) {
        const auto k = static_cast<std::size_t>(x - x0);
        store(place(x, y), sums[k], gathered.empty() ? nullptr : &gathered[k]);
      }
    });
  }

  /// One pass: up to `samples` a pixel where `wanted` says so. gathered: per pixel; empty where no channel gathers.
  void render_tile(int tile, int samples, const std::vector<std::uint8_t>& wanted, std::vector<PixelSums>& all,
                   std::vector<PixelChannels>& gathered) const {
    for_rows(tile, [&](PixelSampling& sampling, int x0, int x1, int y) {
      sample_row(sampling, x0, x1, y, samples, [&](int x) {
        const std::size_t pixel = place(x, y);
        if (wanted[pixel] == 0) return SampledPixel{};
        return SampledPixel{0, 0, &all[pixel], gathered.empty() ? nullptr : &gathered[pixel]};
      });
    });
  }

  /// Means over the samples. gathered: of the other channels; null where none gathers.
  void store(std::size_t pixel, const PixelSums& sums, const PixelChannels* gathered) const {
    std::size_t plane = 0;
    for (const double value : sums.values)
      image_.channels[plane++].pixels[pixel] = static_cast<float>(value / sums.samples);
    if (picture_.catches_shadows) image_.channels[plane++].pixels[pixel] = static_cast<float>(sums.alpha());
    channels_.store(image_, plane, pixel, sums.samples, gathered);
  }

 private:
  int tiles_across() const { return (image_.width + kTile - 1) / kTile; }
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x);
  }

  /// visit(sampling, x0, x1, y): pixels of one row of a tile.
  template <typename Visit>
  void for_rows(int tile, const Visit& visit) const {
    const int x0 = tile % tiles_across() * kTile, y0 = tile / tiles_across() * kTile;
    PixelSampling sampling(picture_, rays_, hash_);
    for (int y = y0; y < std::min(y0 + kTile, image_.height); ++y)
      visit(sampling, x0, std::min(x0 + kTile, image_.width), y);
  }

  /// pixel_at(x): where samples of a pixel go; nowhere if its sums are null.
  template <typename PixelAt>
  void sample_row(PixelSampling& sampling, int x0, int x1, int y, int samples, const PixelAt& pixel_at) const {
    std::array<SampledPixel, kTile> pixels;
    for (int x = x0; x < x1; ++x) {
      SampledPixel& pixel = pixels[static_cast<std::size_t>(x - x0)] = pixel_at(x);
      pixel.x = window_.left + x;
      pixel.y = window_.top + y;
      if (pixel.sums != nullptr) sampling.take(pixel, samples);
    }
    sampling.finish();
  }

  const RenderParams& params_;
  const Picture& picture_;
  const ChannelLayout& channels_;
  Image& image_;
  PixelWindow window_;
  CameraRays rays_;
  std::uint64_t hash_;
};

/// Passes over the picture until it is clean enough, has all its samples, or time is up.
class Passes {
 public:
  Passes(const RenderParams& params, const Frame& frame, const ChannelLayout& channels, const Image& image)
      : params_(params), frame_(frame), width_(image.width), height_(image.height) {
    const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    sums_.resize(pixels);
    if (channels.gathers()) gathered_.assign(pixels, PixelChannels(channels));
    wanted_.assign(pixels, 1);
  }

  /// run_tiles(visit) calls visit(tile) for all tiles of the frame.
  template <typename RunTiles>
  void run(const RunTiles& run_tiles) {
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] { return seconds_since(start); };
    int samples = std::min(first_pass(), params_.samples);
    double before = 0;
    for (;;) {
      run_tiles([&](int tile) { frame_.render_tile(tile, samples, wanted_, sums_, gathered_); });
      const double now = seconds();
      const int next = samples_after_pass(samples, step(), params_.samples);
      if (next == samples || !is_noisy()) break;
      // Half as much again as the last pass: passes grow, and noisy pixels are slow ones.
      if (params_.time_limit > 0 && now + 1.5 * (now - before) > params_.time_limit) break;
      before = now;
      samples = next;
    }
    for (std::size_t k = 0; k < sums_.size(); ++k)
      frame_.store(k, sums_[k], gathered_.empty() ? nullptr : &gathered_[k]);
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
  std::vector<PixelChannels> gathered_;  ///< empty where no channel gathers
  std::vector<std::uint8_t> wanted_;
};

/// Of the whole picture, so that a part of it meets the same trees; the least number where pixels differ in it.
double expected_paths(const RenderParams& params) {
  const int samples = params.time_limit > 0 ? 1 : params.noise > 0 ? params.min_samples : params.samples;
  return static_cast<double>(params.width) * params.height * std::min(samples, params.samples);
}

/// The material twice: as it is, and as it is seen by way of a wide scattering.
void add_bsdfs(Picture& picture, const Appearance& appearance, float least_roughness, AlbedoCache& tables) {
  picture.bsdfs.emplace_back(appearance, tables.of(appearance));
  Appearance blurred = appearance;
  blurred.roughness = std::max(appearance.roughness, least_roughness);
  blurred.coat_roughness = std::max(appearance.coat_roughness, least_roughness);
  const bool same_coat = appearance.coat <= 0 || blurred.coat_roughness == appearance.coat_roughness;
  if (blurred.roughness == appearance.roughness && same_coat)
    picture.blurred.push_back(picture.bsdfs.back());
  else
    picture.blurred.emplace_back(blurred, tables.of(blurred));
}

std::optional<Bsdf> line_bsdf(const MotionMesh& mesh) {
  if (!mesh.lines) return std::nullopt;
  Appearance matt;
  matt.base_color = mesh.lines->color;
  matt.specular = 0;
  return Bsdf(matt);
}

/// Meshes and materials of the scene; the ground comes last.
Picture make_picture(const Scene& scene, const RenderParams& params, const MotionMesh& ground, AlbedoCache& tables) {
  Picture picture;
  picture.max_bounces = params.max_bounces;
  picture.clamp = params.clamp;
  picture.samples = params.samples;
  picture.direct_light = params.direct_light;
  for (const MotionMesh& mesh : scene.meshes) picture.meshes.push_back(&mesh);
  if (scene.ground) picture.meshes.push_back(&ground);
  picture.catches_shadows = scene.ground && scene.ground->shadow_catcher;
  for (const MotionMesh* mesh : picture.meshes) {
    add_bsdfs(picture, mesh->appearance, params.caustic_roughness, tables);
    picture.lines.push_back(line_bsdf(*mesh));
    picture.colored.push_back(
        mesh->coloring.empty() ? nullptr : std::make_unique<ColoredSurface>(*mesh, params.caustic_roughness, tables));
    picture.has_textures = picture.has_textures || !mesh->coloring.maps.empty();
    picture.has_emission = picture.has_emission || mesh->appearance.emission.maxCoeff() > 0;
  }
  picture.pixel =
      2 * camera_frame(scene.camera, params.width, params.height).half_width / static_cast<float>(params.width);
  picture.cone_spread = picture.pixel * cone_share(params.samples);
  if (scene.ground && scene.ground->checker > 0) {
    picture.pattern.emplace(*scene.ground, scene.camera);
    Appearance second = scene.ground->appearance;
    second.base_color = scene.ground->checker_color;
    add_bsdfs(picture, second, params.caustic_roughness, tables);
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
  AlbedoCache tables;  ///< kept from frame to frame
};

PathTracer::PathTracer(const Threads& threads, StageTimes& times)
    : PathTracer(threads, times, make_ray_scene(threads.count())) {}
PathTracer::PathTracer(const Threads& threads, StageTimes& times, std::unique_ptr<RayScene> rays)
    : parts_(std::make_unique<Parts>(threads, times, std::move(rays))) {}
PathTracer::~PathTracer() = default;

ChannelSet RenderParams::all_channels() const {
  ChannelSet all = channels;
  if (auxiliary)
    for (const PictureChannel channel : {PictureChannel::Albedo, PictureChannel::Normal, PictureChannel::Depth})
      all.add(channel);
  if (has_passes()) all.add(PictureChannel::Samples);
  return all;
}

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
  // Light that scatters inside a body needs a tree of it, and a tree cells that are not long. Else the mesh only names
  // the ground and its look.
  const bool ground_apart = scene.ground && !(scene.ground->appearance.subsurface > 0);
  const MotionMesh ground =
      scene.ground ? ground_mesh(*scene.ground, scene.camera, ground_apart ? 1 : kTreeCells) : MotionMesh{};
  parts_->tables.drop_unused();
  Picture picture = make_picture(scene, params, ground, parts_->tables);
  const LightSet lights(scene);
  picture.lights = &lights;
  std::vector<const MotionMesh*> bodies = picture.meshes;
  if (ground_apart) bodies.pop_back();
  {
    const ScopedStage stage(parts_->times, "render/build");
    parts_->threads.run([&] { parts_->rays->build(bodies, expected_paths(params)); });
  }
  const SceneRays rays = ground_apart ? SceneRays(*parts_->rays, bodies, ground_shape(*scene.ground, scene.camera))
                                      : SceneRays(*parts_->rays);
  picture.rays = &rays;
  const ScopedStage stage(parts_->times, "render/trace");
  const ChannelLayout channels(scene, picture, params.all_channels(), params.width, params.height);
  Image image = empty_image(params, channels, picture.catches_shadows);
  const Frame frame(scene, params, picture, channels, image);
  const auto run_tiles = [&](const auto& visit) {
    parts_->threads.for_chunks(frame.tiles(), 1, [&](std::int64_t begin, std::int64_t) {
      if (cancelled && cancelled())
        throw Error(ErrorKind::Interrupt, "Rendering was interrupted; the unfinished picture is dropped.");
      visit(static_cast<int>(begin));
    });
  };
  if (params.has_passes())
    Passes(params, frame, channels, image).run(run_tiles);
  else
    run_tiles([&](int tile) { frame.render_tile(tile); });
  return image;
}

}  // namespace softreel
