#include "tests/support/damaged_shapes.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <utility>

#include "tests/support/surfaces.h"

namespace softreel::test {
namespace {

using Random = std::mt19937;

bool one_in(Random& random, unsigned n) {
  return random() % n == 0;
}

void flip(Triangle& t) {
  std::swap(t[1], t[2]);
}

Vec3 centroid(const SurfaceMesh& mesh, const Triangle& t) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : t) sum += mesh.positions[static_cast<std::size_t>(v)];
  return sum / 3;
}

}  // namespace

SurfaceMesh ball(double radius, const Vec3& center) {
  return make_sphere(radius, 12, center);
}

SurfaceMesh block(const Vec3& half, const Vec3& center) {
  return make_box(half, 1, center);
}

SurfaceMesh flipped(SurfaceMesh mesh) {
  for (Triangle& t : mesh.triangles) flip(t);
  return mesh;
}

SurfaceMesh without(SurfaceMesh mesh, const std::function<bool(const Vec3&)>& gone) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return gone(centroid(mesh, t)); });
  return mesh;
}

SurfaceMesh with(SurfaceMesh mesh, const SurfaceMesh& other) {
  append(mesh, other);
  return mesh;
}

SurfaceMesh moved(SurfaceMesh mesh, double factor, const Vec3& shift) {
  for (Vec3& p : mesh.positions) p = factor * p + shift;
  return mesh;
}

SurfaceMesh soup(const SurfaceMesh& mesh, double noise) {
  Random random(5);
  std::uniform_real_distribution<double> off(-noise, noise);
  SurfaceMesh result;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<Index>(result.positions.size());
    for (const Index v : t)
      result.positions.push_back(mesh.positions[static_cast<std::size_t>(v)] +
                                 (noise > 0 ? Vec3(off(random), off(random), off(random)) : Vec3(Vec3::Zero())));
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

SurfaceMesh sheet() {
  constexpr Index n = 20;
  SurfaceMesh mesh;
  for (Index i = 0; i <= n; ++i)
    for (Index j = 0; j <= n; ++j) {
      const double x = static_cast<double>(i) / n, z = static_cast<double>(j) / n;
      mesh.positions.push_back({x, 0.05 * std::sin(6 * x) * std::cos(4 * z), z});
    }
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const Index a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  return mesh;
}

SurfaceMesh moebius() {
  constexpr Index n = 60;
  SurfaceMesh mesh;
  for (Index i = 0; i < n; ++i)
    for (const double s : {-0.3, -0.1, 0.1, 0.3}) {
      const double a = 2 * std::numbers::pi * i / n, r = 1 + s * std::cos(0.5 * a);
      mesh.positions.push_back({r * std::cos(a), s * std::sin(0.5 * a), r * std::sin(a)});
    }
  const auto vertex = [](Index i, Index k) { return i == n ? 3 - k : 4 * i + k; };
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < 3; ++k) {
      mesh.triangles.push_back({vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1)});
      mesh.triangles.push_back({vertex(i, k), vertex(i + 1, k + 1), vertex(i, k + 1)});
    }
  return mesh;
}

SurfaceMesh crossed_tube(double radius) {
  return make_ring(160, 24, [&](double a, double b) -> Vec3 {
    const Vec3 center(std::sin(a), 0, std::sin(a) * std::cos(a)), along(std::cos(a), 0, std::cos(2 * a));
    const Vec3 side = along.cross(Vec3::UnitY()).normalized();
    return center + radius * (std::cos(b) * side + std::sin(b) * Vec3::UnitY());
  });
}

SurfaceMesh with_t_junctions(SurfaceMesh mesh) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; t += 4) {
    const auto [a, b, c] = mesh.triangles[t];
    const auto middle = static_cast<Index>(mesh.positions.size());
    mesh.positions.push_back(
        0.5 * (mesh.positions[static_cast<std::size_t>(a)] + mesh.positions[static_cast<std::size_t>(b)]));
    mesh.triangles[t] = {a, middle, c};
    mesh.triangles.push_back({middle, b, c});
  }
  return mesh;
}

SurfaceMesh half_flipped(SurfaceMesh mesh) {
  for (Triangle& t : mesh.triangles)
    if (centroid(mesh, t).x() > 0) flip(t);
  return mesh;
}

SurfaceMesh with_many_holes(SurfaceMesh mesh) {
  Random random(1);
  std::erase_if(mesh.triangles, [&](const Triangle&) { return one_in(random, 20); });
  return mesh;
}

SurfaceMesh some_flipped(SurfaceMesh mesh, unsigned n) {
  Random random(2);
  for (Triangle& t : mesh.triangles)
    if (one_in(random, n)) flip(t);
  return mesh;
}

SurfaceMesh with_some(SurfaceMesh mesh, Triangle (*made_from)(const Triangle&)) {
  Random random(2);
  const std::vector<Triangle> before = mesh.triangles;
  for (const Triangle& t : before)
    if (one_in(random, 4)) mesh.triangles.push_back(made_from(t));
  return mesh;
}

SurfaceMesh with_slivers(const SurfaceMesh& mesh) {
  SurfaceMesh result = with_t_junctions(mesh);
  for (std::size_t t = 0, middle = mesh.positions.size(); middle < result.positions.size(); t += 4, ++middle) {
    const Triangle& whole = mesh.triangles[t];
    result.triangles.push_back({whole[0], whole[1], static_cast<Index>(middle)});
  }
  return result;
}

SurfaceMesh walled() {
  const Vec3 half = Vec3::Constant(0.5);
  SurfaceMesh mesh = with(block(half, Vec3(0, 0, 0)), block(half, Vec3(1, 0, 0)));
  std::size_t walls = 0;
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return centroid(mesh, t).x() == 0.5 && ++walls > 2; });
  return mesh;
}

SurfaceMesh hourglass() {
  SurfaceMesh mesh;
  mesh.positions = {{0, 0, 0}};
  for (const double y : {-2.0, 2.0}) {
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const auto& [x, z] : {std::pair{-1.0, -1.0}, {-1.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}})
      mesh.positions.push_back({x, y, z});
    for (Index k = 0; k < 4; ++k) {
      Triangle side{0, first + k, first + (k + 1) % 4};
      if (y < 0) flip(side);
      mesh.triangles.push_back(side);
    }
    for (const Index k : {1, 2}) {
      Triangle base{first, first + k + 1, first + k};
      if (y < 0) flip(base);
      mesh.triangles.push_back(base);
    }
  }
  return mesh;
}

}  // namespace softreel::test
