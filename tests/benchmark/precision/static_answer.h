/// Equilibrium of a body by softreel, timed.
#pragma once

#include <vector>

#include "core/dynamics/simulator.h"

namespace softreel::bench {

struct StaticAnswer {
  double seconds = 0;  ///< processor time from the model to the answer
  std::vector<Vec3> positions;
  double elastic_energy = 0;  ///< J
};

/// Parameters of accuracy benchmarks: the linear material itself, without the cap on dilatation (design 4.3).
SolverParams uncapped_params();

/// Equilibrium at frame 1 on one thread. Throws std::runtime_error if none is found.
StaticAnswer find_static_answer(BodyModel model, const SolverParams& params);

/// The same; a short run is repeated, and its time the middle one (steady_seconds).
StaticAnswer time_static_answer(const BodyModel& model, const SolverParams& params);

}  // namespace softreel::bench
