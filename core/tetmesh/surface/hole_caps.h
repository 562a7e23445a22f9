/// Where the boundary of a filled surface closes a hole of it: there is no surface to keep to.
#pragma once

#include <optional>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/mesh/winding_number.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

/// The solid of an open surface ends where the winding number's size passes 1/2: at the surface in a jump, across its
/// holes smoothly. A point is on a cap if the winding number passes 1/2 nearer to it than the surface is: what ought to
/// bound the solid there is the closing of a hole. Round closed surfaces winding numbers are integers, and nothing is a
/// cap, however far away. Reading is thread-safe.
class HoleCaps {
 public:
  /// The tree is that of the surface and is borrowed.
  HoleCaps(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, const TriangleTree& tree);

  /// False for closed surfaces: they have no caps, and asking costs nothing.
  bool any() const { return winding_.has_value(); }

  /// Whether a point of the boundary is on a cap. The ball round it that the surface leaves free is looked at in its
  /// middle and at 14 places near its skin. Cost: a search for the nearest triangle and as many winding numbers.
  bool contain(const Vec3& p) const;

  /// The faces of a boundary without what lies on caps and is further than `limit` (m) from the surface, cut to pieces
  /// where a cap ends. All points stay, new ones come after them.
  SurfaceMesh without_caps(const std::vector<Vec3>& points, const std::vector<Triangle>& faces, double limit,
                           const Threads& threads) const;

 private:
  const TriangleTree& tree_;
  std::optional<WindingNumber> winding_;
};

}  // namespace softreel
