/// What no shot should ask for, by every rotation method: steps far too short and too long, extreme materials, slivers,
/// pins that jump, constraints that contradict each other, pulls of any stiffness, and very long runs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/dynamics/simulator.h"
#include "tests/benchmark/bench.h"
#include "tests/benchmark/stability/watch.h"

namespace softreel::bench {

/// One body under one kind of abuse.
struct Abuse {
  std::string name;
  std::function<BodyModel()> make_model;
  std::function<SimulationState(const Simulator&)> start{};  ///< empty: at rest
  double seconds = 1.0 / 24;                                 ///< of a step
  int steps = 240;
  bool free = false;     ///< nothing holds it: momentum is judged, and no flutter
  double last_work = 0;  ///< frame after which pins do not move
};

/// All kinds. slivers: tetrahedra with dihedral angles of 0.1 degree.
std::vector<Abuse> abuses(const TetMesh& slivers, bool quick);

struct AbuseResult {
  Verdict verdict;
  double flutter = 0;  ///< degrees a step at the end; NaN for free bodies
  bool free = false;   ///< its momentum counts
};

/// What to see of a run at a glance.
std::string in_a_word(const AbuseResult& result);

AbuseResult run_abuse(const Abuse& abuse, const SolverParams& params);

/// A bar of which every eighth tetrahedron is cut in four by a node near one of its faces: the piece on that face has
/// dihedral angles of `degrees`.
TetMesh sliver_bar(double degrees);

void study_abuse(const BenchOptions& options, Report& report);

/// Bars of 1,008 tetrahedra shaken by their pins for 100,000 steps.
void study_long_runs(const BenchOptions& options, Report& report);

}  // namespace softreel::bench
