/// How a body follows its held nodes to new places before anything is solved.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/types.h"
#include "core/dynamics/simulator_parts.h"

namespace softreel {

/// Moves every piece by the rigid motion that carries its held nodes nearest to their targets in the mean, so that a
/// rigid motion of all pins by any angle moves the body rigidly. Ties (held nodes on a line, say) turn the least.
void follow_rigidly(const Pieces& pieces, std::span<const std::uint8_t> held, std::span<const Vec3> targets,
                    std::span<Vec3> positions, std::span<Quaternion> rotations, const std::vector<Tet>& tets);

}  // namespace softreel
