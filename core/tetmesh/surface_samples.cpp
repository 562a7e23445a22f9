#include "core/tetmesh/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace softreel {
namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// Steps along the longest edge of a triangle.
std::int32_t count_steps(const SurfaceMesh& surface, Index triangle, double step) {
  const auto& [a, b, c] = surface.triangles[at(triangle)];
  const Vec3 &x = surface.positions[at(a)], &y = surface.positions[at(b)], &z = surface.positions[at(c)];
  return static_cast<std::int32_t>(std::ceil(std::max({0.0, (x - y).norm(), (y - z).norm(), (z - x).norm()}) / step));
}

/// Points of a grid whose rows have steps + 1, steps ... 1 points.
std::int64_t grid_size(std::int64_t steps) {
  return steps > 1 ? (steps + 1) * (steps + 2) / 2 : 0;
}

/// Row and column of a point of the grid. Counted from its end, row r begins at r (r + 1) / 2.
std::array<std::int32_t, 2> grid_place(std::int32_t steps, Index point) {
  const std::int64_t from_end = grid_size(steps) - 1 - point;
  const auto row = static_cast<std::int64_t>((std::sqrt(8.0 * static_cast<double>(from_end) + 1) - 1) / 2);
  return {static_cast<std::int32_t>(steps - row), static_cast<std::int32_t>(row - (from_end - row * (row + 1) / 2))};
}

}  // namespace

SurfaceSamples::SurfaceSamples(const SurfaceMesh& surface, const std::vector<Index>& order, double step)
    : surface_(surface) {
  grids_.reserve(order.size());
  std::vector<bool> taken(surface.positions.size(), false);
  std::int64_t count = 0;
  for (const Index t : order) {
    Grid grid{t, static_cast<Index>(count), count_steps(surface, t, step), 0};
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::size_t corner = at(surface.triangles[at(t)][k]);
      if (!taken[corner]) grid.corners[grid.new_corners++] = k;
      taken[corner] = true;
    }
    count += grid.new_corners + grid_size(grid.steps);
    if (count > std::numeric_limits<Index>::max()) throw std::bad_alloc();  // more than there is an index for
    grids_.push_back(grid);
  }
  grids_of_.reserve(static_cast<std::size_t>(count));
  for (std::size_t g = 0; g < grids_.size(); ++g)
    grids_of_.insert(grids_of_.end(), grids_[g].new_corners + static_cast<std::size_t>(grid_size(grids_[g].steps)),
                     static_cast<Index>(g));
}

Vec3 SurfaceSamples::operator[](std::size_t sample) const {
  const Grid& grid = grids_[at(grids_of_[sample])];
  const Triangle& triangle = surface_.triangles[at(grid.triangle)];
  const auto corner = [&](std::size_t k) -> const Vec3& { return surface_.positions[at(triangle[k])]; };
  const Index own = static_cast<Index>(sample) - grid.first;
  if (own < grid.new_corners) return corner(grid.corners[at(own)]);
  const auto [row, column] = grid_place(grid.steps, own - grid.new_corners);
  const Vec3& origin = corner(0);
  return origin + (static_cast<double>(row) / grid.steps) * (corner(1) - origin) +
         (static_cast<double>(column) / grid.steps) * (corner(2) - origin);
}

}  // namespace softreel
