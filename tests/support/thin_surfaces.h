/// Closed surfaces with parts that are thinner than any lattice they are put on.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel::test {

/// A surface round the x axis: rings of radius r at x, poles before the first and after the last one.
inline SurfaceMesh make_spindle(const std::vector<std::pair<double, double>>& rings, double first, double last,
                                Index around) {
  SurfaceMesh mesh;
  mesh.positions = {Vec3(first, 0, 0), Vec3(last, 0, 0)};
  for (const auto& [x, r] : rings)
    for (Index i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      mesh.positions.emplace_back(x, r * std::cos(angle), r * std::sin(angle));
    }
  const auto vertex = [&](std::size_t ring, Index i) { return 2 + static_cast<Index>(ring) * around + i % around; };
  for (Index i = 0; i < around; ++i) {
    mesh.triangles.push_back({0, vertex(0, i + 1), vertex(0, i)});
    mesh.triangles.push_back({1, vertex(rings.size() - 1, i), vertex(rings.size() - 1, i + 1)});
    for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
      mesh.triangles.push_back({vertex(k, i), vertex(k, i + 1), vertex(k + 1, i + 1)});
      mesh.triangles.push_back({vertex(k, i), vertex(k + 1, i + 1), vertex(k + 1, i)});
    }
  }
  return mesh;
}

/// Two unit balls at x = -2 and 2, joined by a rod.
inline SurfaceMesh make_dumbbell(double rod_radius) {
  std::vector<std::pair<double, double>> rings;
  const double neck = std::asin(rod_radius);
  for (int k = 1; k <= 12; ++k) {
    const double angle = (std::numbers::pi - neck) * k / 12;
    rings.emplace_back(-2 - std::cos(angle), std::sin(angle));
  }
  for (std::size_t k = rings.size(); k-- > 0;) rings.emplace_back(-rings[k].first, rings[k].second);
  return make_spindle(rings, -3, 3, 16);
}

/// A palm of 1 x (2 thick + gap) x 0.2 m with two fingers of `length`, `thick` each, `gap` apart; a fork along x.
inline SurfaceMesh make_fork(double length, double thick, double gap) {
  const double top = 2 * thick + gap, end = 1 + length, inner = thick + gap;
  const std::vector<Vec2> outline{{0, 0},     {1, 0},       {end, 0},   {end, thick}, {1, thick},
                                  {1, inner}, {end, inner}, {end, top}, {1, top},     {0, top}};
  const std::vector<Triangle> cap{{0, 1, 4}, {0, 4, 5}, {0, 5, 8}, {0, 8, 9},
                                  {1, 2, 3}, {1, 3, 4}, {5, 6, 7}, {5, 7, 8}};
  SurfaceMesh mesh;
  const auto n = static_cast<Index>(outline.size());
  for (const double z : {-0.1, 0.1})
    for (const Vec2& p : outline) mesh.positions.emplace_back(p.x(), p.y(), z);
  for (const auto& [a, b, c] : cap) {
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({n + a, n + b, n + c});
  }
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
  }
  return mesh;
}

}  // namespace softreel::test
