/// Points all over a surface.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Points of a surface: its used vertices, and a grid with steps of at most `step` over triangles with longer edges. In
/// the order of the triangles in `order`, which should be that of a tree: neighbours are to be near in memory.
///
/// Four bytes a point: where it lies is worked out when it is asked for. Copies share these.
class SurfaceSamples {
 public:
  /// kEach: points on an edge with every triangle of it. kOnce: with the first of them only; about a third as many.
  enum Repeats { kEach, kOnce };

  /// surface: borrowed; only its positions and triangles matter.
  SurfaceSamples(const SurfaceMesh& surface, const std::vector<Index>& order, double step, Repeats repeats = kEach);

  std::size_t size() const { return (table_->grids_of.size() + stride_ - 1) / stride_; }
  Vec3 operator[](std::size_t sample) const;

  /// The first, and every stride-th after it.
  SurfaceSamples thinned(std::size_t stride) const;

 private:
  /// The samples of one triangle: corners that no triangle before it has; where each is to come once, points inside the
  /// edges that none before it has, and the grid inside; else the whole grid.
  struct Grid {
    Index triangle;
    Index first;  ///< sample
    std::int32_t steps;
    std::uint8_t new_corners = 0, new_edges = 0;     ///< how many
    std::array<std::uint8_t, 3> corners{}, edges{};  ///< which; edge k goes from corner k to the next
  };
  struct Table {
    std::vector<Grid> grids;      ///< of the triangles that have samples
    std::vector<Index> grids_of;  ///< per sample
  };

  Vec3 point_of_grid(const Grid& grid, Index point) const;
  Vec3 point_inside(const Grid& grid, Index point) const;
  Vec3 at_share(const Triangle& triangle, double along_first, double along_second) const;

  const SurfaceMesh& surface_;
  Repeats repeats_;
  std::size_t stride_ = 1;
  std::shared_ptr<const Table> table_;
};

}  // namespace softreel
