/// Whether anything carries the weight of a body in an equilibrium: what holds its pieces, and with how much strength.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/dynamics/simulator_parts.h"

namespace softreel {

/// Throws input_error if under gravity a piece has nothing that holds it (held: per piece, as Parts::held_pieces), or
/// nothing but pulls and glue whose max_force, all together, is less than its weight.
void check_holding(const Simulator::Parts& parts, const std::vector<std::uint8_t>& held, const PinnedNodes& pinned,
                   const std::vector<ActivePull>& pulls, double frame);

/// Names the first pull or glue that pulls with all of its max_force at `positions` on a piece that no pin and no pull
/// without a limit holds; empty if there is none.
std::string find_spent_pull(const Simulator::Parts& parts, const PinnedNodes& pinned, const Grabs& grabs,
                            const std::vector<GlueBond>& bonds, double frame, std::span<const Vec3> positions);

}  // namespace softreel
