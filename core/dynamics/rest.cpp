/// When a body need not be stepped.
#include "core/dynamics/static_solver.h"
#include "core/dynamics/step_work.h"

namespace softreel {
namespace {

/// Of SolverParams::rest_tolerance, s. Not the step: shorter ones would stop what moves faster.
constexpr double kTime = 1.0 / 24;

/// Cheap, so it comes first: a body that moves is seen at its first fast node.
bool is_still(const SimulationState& state, double fastest) {
  for (const Vec3& velocity : state.velocities)
    if (!(velocity.squaredNorm() <= fastest * fastest)) return false;
  return true;
}

bool pins_stay(const PinnedNodes& pinned, std::span<const Vec3> positions) {
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (pinned.held[i] != 0 && positions[i] != pinned.targets[i]) return false;
  return true;
}

}  // namespace

bool is_at_rest(Simulator::Parts& parts, const PinnedNodes& pinned, const std::vector<ActivePull>& pulls) {
  const double tolerance = parts.params.rest_tolerance;
  const SimulationState& state = parts.state;
  if (!state.troubles.empty()) return false;  // recovery counts its steps
  if (tolerance == 0 || !is_still(state, tolerance * parts.body_size / kTime)) return false;
  if (!pins_stay(pinned, state.positions)) return false;
  KnownRest& rest = parts.known_rest;
  if (rest.known && rest.held == pinned.held && rest.pulls == pulls) return true;
  const std::vector<std::uint8_t> held_pieces = parts.held_pieces(pinned, pulls);
  StaticSolver statics(parts, pinned.held, held_pieces, pulls);
  StaticState now{state.positions, state.rotations, {}};
  statics.evaluate(now);
  std::vector<Mat3>().swap(parts.stresses);  // steps in float do without
  if (!balances(now, parts.params.force_tolerance, 1)) return false;
  rest = {true, pinned.held, pulls};
  return true;
}

}  // namespace softreel
