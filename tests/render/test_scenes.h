/// Shapes and measurements shared by the tests of render.
#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "render/image/image.h"
#include "render/pathtrace/path_tracer.h"
#include "render/scene/scene.h"

namespace softreel {

/// A square in the plane y = height, seen from above, with edges 2 * half.
inline MotionMesh square(float half, float height, const Appearance& appearance) {
  MotionMesh mesh;
  mesh.name = "square";
  mesh.appearance = appearance;
  mesh.times.resize(1);
  mesh.times[0].positions = {Vec3f(-half, height, half), Vec3f(half, height, half), Vec3f(half, height, -half),
                             Vec3f(-half, height, -half)};
  mesh.times[0].normals.assign(4, Vec3f(0, 1, 0));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A sphere with exact normals; closed at the seam and the poles.
inline MotionMesh sphere(const Vec3f& center, float radius, const Appearance& appearance, int rows = 24) {
  MotionMesh mesh;
  mesh.name = "sphere";
  mesh.appearance = appearance;
  mesh.times.resize(1);
  const int columns = 2 * rows;
  MotionMesh::Time& time = mesh.times[0];
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double polar = M_PI * r / rows, azimuth = 2 * M_PI * c / columns;
      const double ring = r == 0 || r == rows ? 0.0 : std::sin(polar);
      const Vec3f n(static_cast<float>(ring * std::cos(azimuth)), static_cast<float>(std::cos(polar)),
                    static_cast<float>(-ring * std::sin(azimuth)));
      time.normals.push_back(n);
      time.positions.push_back(center + radius * n);
    }
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int next = (c + 1) % columns;
      const Index a = r * columns + c, b = r * columns + next, d = a + columns, e = b + columns;
      if (r > 0) mesh.triangles.push_back({a, d, b});
      if (r + 1 < rows) mesh.triangles.push_back({b, d, e});
    }
  return mesh;
}

/// A cube about the origin with edges 2 * half, of 8 vertices and 12 triangles; each side has the one normal it is flat
/// by.
inline MotionMesh hard_cube(float half, const Appearance& appearance) {
  MotionMesh mesh;
  mesh.name = "cube";
  mesh.appearance = appearance;
  mesh.times.resize(1);
  for (int k = 0; k < 8; ++k)
    mesh.times[0].positions.emplace_back((k & 1) != 0 ? half : -half, (k & 2) != 0 ? half : -half,
                                         (k & 4) != 0 ? half : -half);
  mesh.times[0].normals = {-Vec3f::UnitZ(), Vec3f::UnitZ(),  -Vec3f::UnitY(),
                           Vec3f::UnitY(),  -Vec3f::UnitX(), Vec3f::UnitX()};
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (Index t = 0; t < 12; ++t) mesh.normal_triangles.push_back({t / 2, t / 2, t / 2});
  return mesh;
}

inline Appearance matte(float albedo) {
  Appearance appearance;
  appearance.base_color = Vec3f::Constant(albedo);
  appearance.specular = 0;
  return appearance;
}

/// Nothing but a constant sky.
inline Scene scene_in_sky(float radiance) {
  Scene scene;
  scene.environment.zenith = scene.environment.horizon = scene.environment.nadir = Vec3f::Constant(radiance);
  return scene;
}

/// Looks straight down at the origin from a height; the picture covers `width` metres of the plane y = 0.
inline Camera camera_above(float height, float width) {
  Camera camera;
  camera.position = Vec3f(0, height, 0);
  camera.target = Vec3f(0, 0, 0);
  camera.up = Vec3f(0, 0, -1);
  camera.sensor_width_mm = 36;
  camera.focal_length_mm = 36 * height / width;
  return camera;
}

inline Image rendered(const Scene& scene, const RenderParams& params, int threads = 2) {
  const Threads run_on(threads);
  StageTimes times;
  return PathTracer(run_on, times).render(scene, params);
}

inline RenderParams small_params(int size, int samples) {
  RenderParams params;
  params.width = params.height = size;
  params.samples = samples;
  return params;
}

inline double mean_of(const Channel& channel) {
  double sum = 0;
  for (const float value : channel.pixels) sum += static_cast<double>(value);
  return sum / static_cast<double>(channel.pixels.size());
}

/// Root of the mean squared difference of two channels.
inline double rms_difference(const Channel& a, const Channel& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.pixels.size(); ++k)
    sum += std::pow(static_cast<double>(a.pixels[k]) - static_cast<double>(b.pixels[k]), 2);
  return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

}  // namespace softreel
