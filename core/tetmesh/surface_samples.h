/// Points all over a surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Points of a surface: its used vertices, and a grid with steps of at most `step` over triangles with longer edges. In
/// the order of the triangles in `order`, which should be that of a tree: neighbours are to be near in memory.
///
/// Four bytes a point: where it lies is worked out when it is asked for.
class SurfaceSamples {
 public:
  /// surface: borrowed; only its positions and triangles matter.
  SurfaceSamples(const SurfaceMesh& surface, const std::vector<Index>& order, double step);

  std::size_t size() const { return grids_of_.size(); }
  Vec3 operator[](std::size_t sample) const;

 private:
  /// The samples of one triangle: corners that no triangle before it has, then its grid.
  struct Grid {
    Index triangle;
    Index first;  ///< sample
    std::int32_t steps;
    std::uint8_t new_corners;               ///< how many
    std::array<std::uint8_t, 3> corners{};  ///< which
  };

  const SurfaceMesh& surface_;
  std::vector<Grid> grids_;
  std::vector<Index> grids_of_;  ///< per sample
};

}  // namespace softreel
