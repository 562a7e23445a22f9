/// Whether triangles of two surfaces cross.
#pragma once

#include "core/base/types.h"
#include "core/mesh/triangle_clusters.h"

namespace softreel {

/// Whether any triangle of one surface crosses one of another that is moved by `shift`; touching does not count, and
/// faces in one plane cross nowhere.
bool any_cross(const TriangleClusters& first, const TriangleClusters& second, const Vec3& shift);

/// The way to move one of two surfaces a little, along no face of what is modelled along the axes: bodies that overlap
/// cross whether it goes there or back; of bodies whose faces touch one of the two parts them.
inline const Vec3 kAskew(0.61, 0.53, 0.59);

}  // namespace softreel
