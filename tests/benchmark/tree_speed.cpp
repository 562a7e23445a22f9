/// Compares trees that are fitted from a shape at rest with trees built anew, frame by frame, and prints tab-separated
/// values.
///
///   tree_speed REST.obj FRAME.obj ... [--rays N]
///
/// The frames have the vertices and triangles of REST.obj in the same order, as `softreel export` writes them. Shot are
/// N rays (262144 if not given) from a ring of views at the body, and one from each hit in a direction of the cosine
/// lobe.
///
/// Columns: frame; its looseness (tree_fit.h); ms to bring the fitted tree to the frame, least of five; ms to
/// build anew, least of five; cpu ms of the rays with the fitted tree, least of nine; the same with the new one; how
/// many hits were of another triangle.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "core/base/error.h"
#include "render/pathtrace/rays/ray_scene.h"
#include "render/pathtrace/rays/tree_fit.h"

namespace softreel {
namespace {

MotionMesh read_obj(const std::string& path) {
  MotionMesh mesh;
  mesh.times.resize(1);
  std::ifstream file(path);
  if (!file) throw input_error(fmt::format("{}: cannot be opened.", path));
  for (std::string line; std::getline(file, line);) {
    float x = 0, y = 0, z = 0;
    int a = 0, b = 0, c = 0;
    if (std::sscanf(line.c_str(), "v %f %f %f", &x, &y, &z) == 3) mesh.times[0].positions.emplace_back(x, y, z);
    const bool is_face = std::sscanf(line.c_str(), "f %d %d %d", &a, &b, &c) == 3 ||
                         std::sscanf(line.c_str(), "f %d%*[0-9/] %d%*[0-9/] %d", &a, &b, &c) == 3;
    if (is_face) mesh.triangles.push_back({a - 1, b - 1, c - 1});
  }
  return mesh;
}

/// Numbers in [0, 1) of the golden ratio's multiples and their like (R. Krueger's R-sequence).
float spread_number(std::int64_t k, double step) {
  const double value = static_cast<double>(k) * step;
  return static_cast<float>(value - std::floor(value));
}

Vec3f direction(float u, float v) {
  const float z = 1 - 2 * u, ring = std::sqrt(std::max(0.0f, 1 - z * z)), angle = 6.2831853f * v;
  return {ring * std::cos(angle), z, ring * std::sin(angle)};
}

/// From a sphere round the body at points inside its middle half.
std::vector<Ray> first_rays(const MotionMesh& mesh, std::int64_t count) {
  Vec3f low = mesh.times[0].positions.front(), high = low;
  for (const Vec3f& p : mesh.times[0].positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3f middle = 0.5f * (low + high), half = 0.5f * (high - low);
  std::vector<Ray> rays;
  for (std::int64_t k = 0; k < count; ++k) {
    Ray ray;
    const std::int64_t view = k / 4096;
    ray.origin =
        middle + 3 * half.norm() * direction(spread_number(view, 0.7548776662), spread_number(view, 0.5698402910));
    const Vec3f aim(spread_number(k, 0.8191725134), spread_number(k, 0.6710436067), spread_number(k, 0.5497004779));
    ray.direction = (middle + half.cwiseProduct(2 * aim - Vec3f::Ones()) - ray.origin).normalized();
    rays.push_back(ray);
  }
  return rays;
}

/// From what the rays hit into the half space before it.
std::vector<Ray> second_rays(const MotionMesh& mesh, const RayScene& scene, const std::vector<Ray>& first) {
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < first.size(); ++k) {
    RayHit hit;
    if (!scene.intersect(first[k], hit)) continue;
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(hit.triangle)];
    const auto corner = [&](std::size_t c) { return mesh.times[0].positions[static_cast<std::size_t>(t[c])]; };
    Vec3f normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    if (normal.dot(first[k].direction) > 0) normal = -normal;
    const auto n = static_cast<std::int64_t>(k);
    Ray ray;
    ray.origin = first[k].origin + hit.distance * first[k].direction + 1e-4f * normal;
    ray.direction = (normal + direction(spread_number(n, 0.7548776662), spread_number(n, 0.5698402910))).normalized();
    rays.push_back(ray);
  }
  return rays;
}

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// cpu ms; fills in the triangles that were hit, -1: none.
double shoot(const RayScene& scene, const std::vector<Ray>& rays, std::vector<Index>& hits) {
  const double start = cpu_ms();
  for (std::size_t k = 0; k < rays.size(); ++k) {
    RayHit hit;
    hits[k] = scene.intersect(rays[k], hit) ? hit.triangle : -1;
  }
  return cpu_ms() - start;
}

double build_ms(RayScene& scene, const MotionMesh& mesh) {
  double least = 1e30;
  for (int run = 0; run < 5; ++run) {
    const auto start = std::chrono::steady_clock::now();
    scene.build({&mesh}, 1);
    least =
        std::min(least, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

void compare(const MotionMesh& rest, const std::string& path, std::int64_t count, RayScene& fitted) {
  MotionMesh frame = read_obj(path);
  if (frame.triangles != rest.triangles) throw input_error(path + ": has other triangles than the shape at rest.");
  const auto fresh = make_ray_scene(2);
  const double anew = build_ms(*fresh, frame);
  std::vector<Ray> rays = first_rays(frame, count);
  for (const Ray& ray : second_rays(frame, *fresh, rays)) rays.push_back(ray);
  frame.rest_positions = rest.rest_positions;
  const double looseness = TreeFit(*rest.rest_positions, rest.triangles).looseness(frame.times[0].positions);
  const double fit = build_ms(fitted, frame);
  std::vector<Index> hits_fitted(rays.size()), hits_fresh(rays.size());
  double with_fitted = 1e30, with_fresh = 1e30;
  for (int run = 0; run < 9; ++run) {  // by turns, so that both meet the same neighbours on the machine
    with_fitted = std::min(with_fitted, shoot(fitted, rays, hits_fitted));
    with_fresh = std::min(with_fresh, shoot(*fresh, rays, hits_fresh));
  }
  std::int64_t other = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) other += hits_fitted[k] != hits_fresh[k] ? 1 : 0;
  fmt::print("{}\t{:.3f}\t{:.2f}\t{:.2f}\t{:.1f}\t{:.1f}\t{}\n", path, looseness, fit, anew, with_fitted, with_fresh,
             other);
}

int run(int argc, char** argv) {
  std::vector<std::string> paths;
  std::int64_t count = 262144;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--rays") == 0 && k + 1 < argc)
      count = std::stoll(argv[++k]);
    else
      paths.emplace_back(argv[k]);
  }
  if (paths.size() < 2 || count < 1) throw input_error("tree_speed: name the shape at rest and at least one frame.");
  MotionMesh rest = read_obj(paths.front());
  rest.rest_positions = std::make_shared<const std::vector<Vec3f>>(rest.times[0].positions);
  const auto fitted = make_ray_scene(2);
  fitted->build({&rest}, 1);
  fmt::print("frame\tlooseness\tfit_ms\tbuild_ms\tfitted_cpu_ms\tanew_cpu_ms\tother_hits\n");
  for (std::size_t k = 1; k < paths.size(); ++k) compare(rest, paths[k], count, *fitted);
  return 0;
}

}  // namespace
}  // namespace softreel

int main(int argc, char** argv) {
  try {
    return softreel::run(argc, argv);
  } catch (const softreel::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return static_cast<int>(error.kind());
  }
}
