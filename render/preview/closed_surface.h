/// Whether triangles bound a solid, and on which side it is.
#pragma once

#include <vector>

#include "core/base/types.h"

namespace softreel {

enum class SolidSide {
  None,    ///< the triangles have a rim
  Behind,  ///< normals look outward
  Before   ///< normals look inward
};

/// Closed is a surface whose edges are all run through as often in one direction as in the other. That is told from a
/// sum of hashes of the edges, in linear time; of open ones 1 in 2^64 is taken for closed.
SolidSide solid_side(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles);

}  // namespace softreel
