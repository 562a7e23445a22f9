/// Closed test surfaces with known geometry.
#pragma once

#include <cmath>
#include <numbers>

#include "core/mesh/surface_mesh.h"

namespace softreel::test {

/// A grid of quads over two angles, closed in both directions: a tube that comes back to where it began. point(a, b):
/// on it, a along and b round the tube.
template <typename Point>
SurfaceMesh make_ring(Index around, Index across, const Point& point) {
  SurfaceMesh mesh;
  const double turn = 2.0 * std::numbers::pi;
  for (Index i = 0; i < around; ++i)
    for (Index j = 0; j < across; ++j) mesh.positions.push_back(point(turn * i / around, turn * j / across));
  const auto vertex = [&](Index i, Index j) { return (i % around) * across + j % across; };
  for (Index i = 0; i < around; ++i)
    for (Index j = 0; j < across; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
    }
  return mesh;
}

/// A torus round the y axis.
inline SurfaceMesh make_torus(double major, double minor, Index around, Index across, const Vec3& center) {
  return make_ring(around, across, [&](double a, double b) -> Vec3 {
    const double r = major + minor * std::cos(b);
    return center + Vec3(r * std::cos(a), minor * std::sin(b), r * std::sin(a));
  });
}

/// Calls visit(a, b, c) for the triangles of a grid of cells * cells squares, whose points are numbered row by row.
template <typename Visit>
void each_grid_triangle(Index cells, const Visit& visit) {
  for (Index i = 0; i < cells; ++i)
    for (Index j = 0; j < cells; ++j) {
      const Index a = i * (cells + 1) + j, b = a + cells + 1;
      visit(a, b, b + 1);
      visit(a, b + 1, a + 1);
    }
}

/// The six sides of a box, each cut into cells x cells squares, moved by `place`. Vertices are not shared by the sides.
template <typename Place>
SurfaceMesh make_cube_sides(Index cells, const Place& place) {
  SurfaceMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto first = static_cast<Index>(mesh.positions.size());
      for (Index i = 0; i <= cells; ++i)
        for (Index j = 0; j <= cells; ++j) {
          Vec3 p;
          p[axis] = side;
          p[(axis + 1) % 3] = (2 * i - cells) / static_cast<double>(cells);
          p[(axis + 2) % 3] = (2 * j - cells) / static_cast<double>(cells);
          mesh.positions.push_back(place(p));
        }
      const auto add = [&](Index a, Index b, Index c) {
        if (side < 0) std::swap(b, c);
        mesh.triangles.push_back({first + a, first + b, first + c});
      };
      each_grid_triangle(cells, add);
    }
  return mesh;
}

inline SurfaceMesh make_sphere(double radius, Index cells, const Vec3& center) {
  return make_cube_sides(cells, [&](const Vec3& p) { return Vec3(center + radius * p.normalized()); });
}

inline SurfaceMesh make_box(const Vec3& half_size, Index cells, const Vec3& center) {
  return make_cube_sides(cells, [&](const Vec3& p) { return Vec3(center + half_size.cwiseProduct(p)); });
}

inline void append(SurfaceMesh& mesh, const SurfaceMesh& other) {
  const auto first = static_cast<Index>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

inline SurfaceMesh joined(const std::vector<SurfaceMesh>& parts) {
  SurfaceMesh all;
  for (const SurfaceMesh& part : parts) append(all, part);
  return all;
}

inline void turn_inside_out(SurfaceMesh& mesh) {
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

}  // namespace softreel::test
