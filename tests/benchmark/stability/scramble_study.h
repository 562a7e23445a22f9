/// Bodies whose nodes are thrown about and released: which rotation method brings them back, and what it does
/// meanwhile.
#pragma once

#include <string>

#include "core/dynamics/simulator.h"
#include "tests/benchmark/bench.h"
#include "tests/benchmark/stability/methods.h"
#include "tests/benchmark/stability/watch.h"
#include "tests/support/scrambled.h"

namespace softreel::bench {

/// A free body released from one scramble, until it is back or `most_steps` are over.
struct ScrambledRun {
  bool came_back = false;
  Verdict verdict;
  Leftovers left;          ///< at the end
  bool recovered = false;  ///< recovery acted
};

/// across: as scramble_model takes it. Steps of 1/24 s.
ScrambledRun run_scramble(Index across, const testing::Scramble& scramble, RotationMethod rotation, bool recovery,
                          int seed, int most_steps);

/// All scrambles by all methods, recovery on and off.
void study_scrambles(const BenchOptions& options, Report& report);

/// Steps of iterated implicit Euler, from a scramble, whose pins (if `pinned`, those of the low x side) stay and in
/// which recovery does not act: how many gained energy, and how much.
struct EnergyRun {
  Verdict verdict;
  int judged = 0;  ///< steps
};
EnergyRun run_iterated(Index across, const testing::Scramble& scramble, bool pinned, bool damped, int seed, int steps);

/// run_iterated over scrambles, free and pinned, damped and not.
void study_iterated_energy(const BenchOptions& options, Report& report);

}  // namespace softreel::bench
