/// Bars stretched and twisted far beyond what their material is meant for, pose after pose (the paper's figures 4, 5).
#pragma once

#include <vector>

#include "core/dynamics/simulator.h"
#include "tests/benchmark/stability/bar_body.h"
#include "tests/benchmark/stability/watch.h"

namespace softreel::bench {

/// What a bar does in one pose, after it had time to settle.
struct HeldPose {
  double asked = 0;             ///< stretch, 1: rest length; or turns
  double flutter = 0;           ///< degrees a step, of the element that turns most; in twist, what motion is left
  double held = 0;              ///< turns between the ends, section by section
  std::vector<Vec3> positions;  ///< per node, m
};

/// How poses are taken: each within a second of `steps_per_second` steps, then held for `settle` seconds before flutter
/// is measured over a second.
struct PosePace {
  int steps_per_second = 24;
  int settle = 4;
};

/// The stretches in turn, in one run. Ends early where the run fails, as `verdict` says.
std::vector<HeldPose> stretch_bar(const BarBody& bar, const SolverParams& params, const std::vector<double>& stretches,
                                  const PosePace& pace, Verdict& verdict);

/// The same with 0, 1, 2, ... `turns` turns of the far end about the axis, of a bar stretched to `stretch`, so that it
/// does not buckle.
std::vector<HeldPose> twist_bar(const BarBody& bar, const SolverParams& params, int turns, double stretch,
                                const PosePace& pace, Verdict& verdict);

}  // namespace softreel::bench
