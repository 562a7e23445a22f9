/// How far triangles are from a surface at most: one direction of the Hausdorff distance.
#pragma once

#include <vector>

#include "core/base/parallel.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

/// The result of farthest_distance is at most this share of itself too small.
constexpr double kFarthestTolerance = 0.01;

/// Largest distance of any point of the triangles, their insides included, to the nearest triangle of `tree`, m; 0 if
/// either is empty. Vertices that no triangle uses do not count.
///
/// Triangles are quartered where they may hold a farther point than found so far, until they are a quarter as long as
/// the mean edge of the finer side; what lies between adds 0.15 of that edge at most. The distance to one triangle of
/// the tree is convex, so over a triangle it is largest at a corner: the nearest triangles of the corners bound it from
/// above. Cost: a search of the tree per vertex, and some more near the farthest points. Equal bits at any number of
/// threads.
double farthest_distance(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                         const TriangleTree& tree, const Threads& threads);

/// Largest distance of any point of one triangle to the nearest triangle of `tree`, which must not be empty, if that is
/// above `lower`; else `lower`. m. The result is at most a share `tolerance` of itself too small, but for what lies
/// between the corners of parts with edges no longer than `smallest`.
double farthest_of_triangle(const std::array<Vec3, 3>& corners, const TriangleTree& tree, double lower, double smallest,
                            double tolerance);

/// Points of the triangles that are further than `limit` from the tree, found in the same way: where a triangle has
/// some, at least one of them. In the order of the triangles.
std::vector<Vec3> find_far_points(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                  const TriangleTree& tree, double limit, const Threads& threads);

/// Per triangle 1 if it has such a point, else 0.
std::vector<std::uint8_t> find_far_triangles(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                             const TriangleTree& tree, double limit, const Threads& threads);

}  // namespace softreel
