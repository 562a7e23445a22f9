/// Bodies whose nodes are thrown about and then released, and whether they come back to their rest shape.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "core/dynamics/simulator.h"

namespace softreel::testing {

/// A way to throw the nodes of a rest shape about.
struct Scramble {
  std::string name;
  std::function<std::vector<Vec3>(const std::vector<Vec3>& rest, std::mt19937_64& random)> positions;
};

/// Anywhere in the bounding box; on a random plane, a random line, one point; mirrored at a random plane.
const std::vector<Scramble>& scrambles();

/// A free box of (across + 1) x across x across cubes of BCC tetrahedra, 0.1 m each, without gravity. Damped, as a body
/// that leaves such a state may spin, and what spins is stretched.
BodyModel scramble_model(Index across);

struct Release {
  bool came_back = false;
  int steps = 0;            ///< until it had
  Index most_elements = 0;  ///< that shared a rotation in one step
};

/// Steps of 1/24 s from rest at the scrambled positions until the rest shape is back, up to a rigid motion, within 1e-3
/// of its size; at most `most_steps`. Throws std::runtime_error if a step is not solved.
Release release(BodyModel model, const Scramble& scramble, RotationMethod rotation, bool recovery, int seed,
                int most_steps);

/// True if `positions` are the rest shape up to a rigid motion, within 1e-3 of its size.
bool is_back(const std::vector<Vec3>& rest, const std::vector<Vec3>& positions);

/// Greatest distance of `positions` from the rigid motion of `rest` that fits best.
double distance_from_rigid(const std::vector<Vec3>& rest, const std::vector<Vec3>& positions);

}  // namespace softreel::testing
