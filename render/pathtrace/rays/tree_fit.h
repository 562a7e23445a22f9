/// Whether a tree of boxes that was built round a shape at rest is still a good one for the deformed shape.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Groups of triangles that lie close together at rest, as the subtrees of a tree hold them.
///
/// A ray visits a subtree about as often as the area of its box says (the surface area heuristic: Goldsmith and Salmon,
/// "Automatic creation of object hierarchies for ray tracing", 1987). A deformation that pulls a group apart makes its
/// box large while its triangles stay small; one that stretches all alike makes both larger, as it would in a new tree.
class TreeFit {
 public:
  /// triangles: of `rest`, whose positions are in m. Cost: a sort of the triangles.
  TreeFit(std::span<const Vec3f> rest, std::span<const Triangle> triangles);

  /// Area of the groups' boxes over that of the triangles' own boxes, averaged over the sizes of groups, relative to
  /// the same at rest: 1 at rest, and after any motion of the whole by quarter turns, scaling and shifting. Depends on
  /// `positions` alone, to the bit. Infinity where the triangles have no area and the groups do. Cost: one pass over
  /// the triangles.
  double looseness(std::span<const Vec3f> positions) const;

 private:
  double mean_area_ratio(std::span<const Vec3f> positions) const;

  std::vector<Triangle> ordered_;  ///< along a curve that fills space
  double at_rest_ = 0;
};

/// Whether fitting a tree and tracing with it takes less time than building and tracing with a new one. triangles: of
/// the tree; paths: that will be traced.
bool is_worth_fitting(double looseness, std::size_t triangles, double paths);

}  // namespace softreel
