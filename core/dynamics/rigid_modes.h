/// Rigid motions of pieces that nothing holds: the null space of statics.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/types.h"
#include "core/dynamics/pieces.h"

namespace softreel {

/// Takes translation and rotation (mass-weighted, about the centre of mass at `positions`) out of a motion of the
/// nodes, for every piece whose `held` is 0: a free piece keeps its rigid placement.
void remove_rigid_motion(const Pieces& pieces, std::span<const std::uint8_t> held, std::span<const double> masses,
                         std::span<const Vec3> positions, std::span<Vec3> motion);

}  // namespace softreel
