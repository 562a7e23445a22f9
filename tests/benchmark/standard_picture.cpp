/// Renders the standard scene of ../shared/render_refs (an armadillo, a lamp, a constant sky), to be compared with its
/// reference pictures by image_error.py, and prints samples, seconds and paths a second as tab-separated values.
///
///   standard_picture BODY.obj [--material mix|lambert] [--blur] [--spp N] [--threads N] [--size W H]
///                    [--caustic-roughness R] [--output F.exr]
///
/// BODY.obj is arma0_k0.obj of make_meshes.py there; --blur reads its key 1 from arma0_k1.obj beside it. --material:
/// of the body, "lambert" if not given; "mix" is 0.9 Lambert and 0.1 GGX of alpha 0.09 without Fresnel.
/// --caustic-roughness: 0.4 if not given, as in shots; the references blur no caustics.
///
/// Columns: samples a pixel; seconds on the wall of building trees and tracing; paths a second, without the building;
/// the same of nothing but Embree on the rays of the first sample of each pixel, in their order, by one call a ray;
/// the share of the two rates, each by cpu seconds, which other programs on the machine disturb less; cpu seconds of
/// tracing; seconds of building.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <sys/resource.h>

#include "core/base/error.h"
#include "core/base/timer.h"
#include "core/mesh/surface_mesh.h"
#include "render/image/image_io.h"
#include "render/pathtrace/path_tracer.h"
#include "tests/benchmark/recorded_rays.h"

namespace softreel {
namespace {

struct Options {
  std::string body, close, output;
  bool mix = false, blur = false;
  int threads = 0;
  RenderParams params;
};

/// Vertices and triangles of an OBJ file of "v x y z" and "f a b c" lines.
void read_positions(const std::string& path, std::vector<Vec3f>& positions, std::vector<Triangle>* triangles) {
  std::ifstream file(path);
  if (!file) throw input_error(fmt::format("{}: cannot be opened.", path));
  for (std::string line; std::getline(file, line);) {
    float x = 0, y = 0, z = 0;
    int a = 0, b = 0, c = 0;
    if (std::sscanf(line.c_str(), "v %f %f %f", &x, &y, &z) == 3) positions.emplace_back(x, y, z);
    if (triangles != nullptr && std::sscanf(line.c_str(), "f %d %d %d", &a, &b, &c) == 3)
      triangles->push_back({a - 1, b - 1, c - 1});
  }
}

/// Angle-weighted vertex normals, as the references have: with area weights highlights lie elsewhere, and the
/// difference stays at a RMSE of 0.006 however many samples there are.
std::vector<Vec3f> normals_of(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles) {
  SurfaceMesh mesh;
  for (const Vec3f& p : positions) mesh.positions.push_back(p.cast<double>());
  mesh.triangles = triangles;
  std::vector<Vec3f> normals;
  for (const Vec3& n : vertex_normals(mesh, mesh.positions)) normals.push_back(n.cast<float>());
  return normals;
}

MotionMesh read_body(const Options& options) {
  MotionMesh mesh;
  mesh.name = "body";
  mesh.times.resize(options.close.empty() ? 1 : 2);
  read_positions(options.body, mesh.times[0].positions, &mesh.triangles);
  if (!options.close.empty()) read_positions(options.close, mesh.times[1].positions, nullptr);
  for (MotionMesh::Time& time : mesh.times) time.normals = normals_of(time.positions, mesh.triangles);
  mesh.appearance.base_color = Vec3f(0.8f, 0.3f, 0.15f);
  mesh.appearance.specular = 0;
  if (options.mix) {
    mesh.appearance.metallic = 0.1f;
    mesh.appearance.metal_color = Vec3f::Ones();  // Schlick's Fresnel is 1 at every angle
    mesh.appearance.roughness = 0.3f;             // alpha is its square
  }
  return mesh;
}

/// The scene's ground: 20 m square at z = 0 (the scene has z up).
MotionMesh ground() {
  MotionMesh mesh;
  mesh.name = "ground";
  mesh.times.resize(1);
  mesh.times[0].positions = {Vec3f(-10, -10, 0), Vec3f(10, -10, 0), Vec3f(10, 10, 0), Vec3f(-10, 10, 0)};
  mesh.times[0].normals.assign(4, Vec3f(0, 0, 1));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.appearance.base_color = Vec3f(0.5f, 0.5f, 0.5f);
  mesh.appearance.specular = 0;
  return mesh;
}

/// The numbers of standard.scene.json.
Scene standard_scene(const Options& options) {
  Scene scene;
  scene.meshes = {read_body(options), ground()};
  const Vec3f backward(0.16103392839431763f, -0.9662035703659058f, 0.20129244029521942f);
  scene.camera.position = Vec3f(1, -6, 2.2f);
  scene.camera.target = scene.camera.position - backward;
  scene.camera.up = Vec3f(-0.033092256635427475f, 0.1985536366701126f, 0.9795311093330383f);
  AreaLight lamp;
  lamp.center = Vec3f(2.5f, -2.5f, 4);
  // Emits along -z of its frame: u x v must be -z, so the axes change places.
  lamp.u = 0.75f * Vec3f(-0.45749568939208984f, 0.4574955105781555f, 0.7624929547309875f);
  lamp.v = 0.75f * Vec3f(0.7071066498756409f, 0.7071069478988647f, 7.208546648485026e-09f);
  lamp.radiance = Vec3f::Constant(400.0f / (4 * 1.5f * 1.5f));
  scene.area_lights = {lamp};
  scene.environment.zenith = scene.environment.horizon = scene.environment.nadir = Vec3f(0.3f, 0.4f, 0.5f);
  return scene;
}

Options parse(int argc, char** argv) {
  Options options;
  options.params.width = 640;
  options.params.height = 360;
  for (int k = 1; k < argc; ++k) {
    const std::string option = argv[k];
    const auto next = [&]() -> std::string {
      if (k + 1 >= argc) throw input_error(option + " lacks its value.");
      return argv[++k];
    };
    if (option == "--material") {
      const std::string material = next();
      if (material != "mix" && material != "lambert") throw input_error("--material takes mix or lambert.");
      options.mix = material == "mix";
    } else if (option == "--caustic-roughness")
      options.params.caustic_roughness = std::stof(next());
    else if (option == "--blur")
      options.blur = true;
    else if (option == "--spp")
      options.params.samples = std::stoi(next());
    else if (option == "--threads")
      options.threads = std::stoi(next());
    else if (option == "--output")
      options.output = next();
    else if (option == "--size") {
      options.params.width = std::stoi(next());
      options.params.height = std::stoi(next());
    } else
      options.body = option;
  }
  if (options.body.empty()) throw input_error("standard_picture: name the body's OBJ file.");
  if (options.blur) {
    const std::size_t key = options.body.rfind("_k0.obj");
    if (key == std::string::npos) throw input_error("--blur needs a body whose name ends in _k0.obj, and _k1.obj.");
    options.close = options.body.substr(0, key) + "_k1.obj";
  }
  return options;
}

struct Seconds {
  double wall = 0, cpu = 0;
};

/// What work takes.
template <typename Work>
Seconds seconds_of(const Work& work) {
  const auto cpu = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  };
  const double cpu_before = cpu();
  const auto start = std::chrono::steady_clock::now();
  work();
  const double wall = seconds_since(start);
  return {wall, cpu() - cpu_before};
}

/// Least of a few runs of Embree alone on the rays of one path a pixel.
Seconds raw_seconds(const Scene& scene, const Options& options, const Threads& threads) {
  const Threads one(1);
  StageTimes times;
  auto recording = std::make_unique<RecordingScene>(make_ray_scene(threads.count()));
  const RecordingScene& recorded = *recording;
  PathTracer tracer(one, times, std::move(recording));
  RenderParams params = options.params;
  params.samples = 1;
  tracer.render(scene, params);
  Seconds least{1e30, 1e30};
  std::int64_t hits = 0;
  for (int k = 0; k < 4; ++k) {
    const Seconds seconds = seconds_of([&] { hits = recorded.shoot_again(threads); });
    least = {std::min(least.wall, seconds.wall), std::min(least.cpu, seconds.cpu)};
  }
  fmt::print(stderr, "{} rays of {} x {} paths, {} of them hit\n", recorded.count(), params.width, params.height, hits);
  return least;
}

void run(const Options& options) {
  const Scene scene = standard_scene(options);
  const Threads threads(options.threads);
  StageTimes times;
  PathTracer tracer(threads, times);
  Image image;
  Seconds traced = seconds_of([&] { image = tracer.render(scene, options.params); });
  const double build = times.entries()["render/build"].seconds;
  const double pixels = static_cast<double>(options.params.width) * options.params.height;
  const double paths = pixels * options.params.samples;
  const Seconds raw = raw_seconds(scene, options, threads);
  fmt::print("spp\tseconds\tpaths_per_second\traw_paths_per_second\tshare\tcpu_seconds\tbuild_seconds\n");
  fmt::print("{}\t{:.4f}\t{:.4g}\t{:.4g}\t{:.3f}\t{:.4f}\t{:.4f}\n", options.params.samples, traced.wall,
             paths / (traced.wall - build), pixels / raw.wall, raw.cpu * options.params.samples / traced.cpu,
             traced.cpu, build);
  if (options.output.empty()) return;
  const std::vector<std::uint8_t> bytes = encode_exr(image);
  std::ofstream(options.output, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  try {
    softreel::run(softreel::parse(argc, argv));
    return 0;
  } catch (const softreel::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return static_cast<int>(error.kind());
  }
}
