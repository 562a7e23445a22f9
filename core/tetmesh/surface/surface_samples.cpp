#include "core/tetmesh/surface/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/tetmesh/key_index.h"

namespace softreel {
namespace {

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

/// Of them, those on no edge.
std::int64_t inside_size(std::int64_t steps) {
  return steps > 2 ? (steps - 1) * (steps - 2) / 2 : 0;
}

/// Row and column of a point of the grid. Counted from its end, row r begins at r (r + 1) / 2.
std::array<std::int32_t, 2> grid_place(std::int32_t steps, Index point) {
  const std::int64_t from_end = (steps + std::int64_t{1}) * (steps + 2) / 2 - 1 - point;
  const auto row = static_cast<std::int64_t>((std::sqrt(8.0 * static_cast<double>(from_end) + 1) - 1) / 2);
  return {static_cast<std::int32_t>(steps - row), static_cast<std::int32_t>(row - (from_end - row * (row + 1) / 2))};
}

}  // namespace

SurfaceSamples::SurfaceSamples(const SurfaceMesh& surface, const std::vector<Index>& order, double step,
                               Repeats repeats)
    : surface_(surface), repeats_(repeats) {
  auto table = std::make_shared<Table>();
  std::vector<bool> taken(surface.positions.size(), false);
  KeyIndex taken_edges;
  std::int64_t count = 0;
  for (const Index t : order) {
    const Triangle& triangle = surface.triangles[at(t)];
    Grid grid{t, static_cast<Index>(count), count_steps(surface, t, step)};
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::size_t corner = at(triangle[k]);
      if (!taken[corner]) grid.corners[grid.new_corners++] = k;
      taken[corner] = true;
      if (repeats == kEach || grid.steps < 2) continue;
      const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1U) % 3]);
      const std::uint64_t key = static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
      if (taken_edges.insert(key).second) grid.edges[grid.new_edges++] = k;
    }
    const std::int64_t steps = grid.steps;
    const std::int64_t size =
        grid.new_corners + (repeats == kEach ? grid_size(steps) : grid.new_edges * (steps - 1) + inside_size(steps));
    if (size == 0) continue;  // about half of the triangles of a fine surface: there are two for each vertex
    count += size;
    if (count > std::numeric_limits<Index>::max()) throw std::bad_alloc();  // more than there is an index for
    table->grids.push_back(grid);
  }
  table->grids.shrink_to_fit();
  table->grids_of.resize(static_cast<std::size_t>(count));
  for (std::size_t g = 0; g < table->grids.size(); ++g) {
    const bool is_last = g + 1 == table->grids.size();
    const auto end = is_last ? table->grids_of.end() : table->grids_of.begin() + table->grids[g + 1].first;
    std::fill(table->grids_of.begin() + table->grids[g].first, end, static_cast<Index>(g));
  }
  table_ = std::move(table);
}

Vec3 SurfaceSamples::at_share(const Triangle& triangle, double along_first, double along_second) const {
  const Vec3& origin = surface_.positions[at(triangle[0])];
  return origin + along_first * (surface_.positions[at(triangle[1])] - origin) +
         along_second * (surface_.positions[at(triangle[2])] - origin);
}

Vec3 SurfaceSamples::point_of_grid(const Grid& grid, Index point) const {
  const auto [row, column] = grid_place(grid.steps, point);
  return at_share(surface_.triangles[at(grid.triangle)], static_cast<double>(row) / grid.steps,
                  static_cast<double>(column) / grid.steps);
}

/// Points inside new edges, one edge after the other, then those inside: the grid of three steps less.
Vec3 SurfaceSamples::point_inside(const Grid& grid, Index point) const {
  const Triangle& triangle = surface_.triangles[at(grid.triangle)];
  const Index per_edge = grid.steps - 1;
  if (point < grid.new_edges * per_edge) {
    const std::size_t k = grid.edges[at(point / per_edge)];
    const Vec3 &from = surface_.positions[at(triangle[k])], &to = surface_.positions[at(triangle[(k + 1) % 3])];
    return from + (static_cast<double>(point % per_edge + 1) / grid.steps) * (to - from);
  }
  const auto [row, column] = grid_place(grid.steps - 3, point - grid.new_edges * per_edge);
  return at_share(triangle, static_cast<double>(row + 1) / grid.steps, static_cast<double>(column + 1) / grid.steps);
}

Vec3 SurfaceSamples::operator[](std::size_t sample) const {
  const std::size_t place = sample * stride_;
  const Grid& grid = table_->grids[at(table_->grids_of[place])];
  const Index own = static_cast<Index>(place) - grid.first;
  if (own < grid.new_corners)
    return surface_.positions[at(surface_.triangles[at(grid.triangle)][grid.corners[at(own)]])];
  return repeats_ == kEach ? point_of_grid(grid, own - grid.new_corners) : point_inside(grid, own - grid.new_corners);
}

SurfaceSamples SurfaceSamples::thinned(std::size_t stride) const {
  SurfaceSamples some = *this;
  some.stride_ *= stride;
  return some;
}

}  // namespace softreel
