/// Points on triangles, for distances that are looked at in samples.
#pragma once

#include <vector>

#include "core/base/types.h"

namespace softreel {

/// All vertices that triangles use, once each, and points of a grid over each triangle with edges longer than `step`,
/// so that neighbours on an edge are no further apart than that; in the order of the triangles.
std::vector<Vec3> sample_triangles(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                   double step);

}  // namespace softreel
