/// The methods that precision compares: softreel's schemes, what else softreel can compute with, and rivals.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/benchmark/precision/work_precision.h"
#include "tests/benchmark/steppers/stepper.h"

namespace softreel::bench {

struct Method {
  std::string label;
  std::string curve;  ///< of the plot; methods of one curve show their common front
  bool ours = false;
  std::string tuned;                      ///< one sentence for the report: what it is, and how its users would set it
  std::vector<double> tolerances{kNone};  ///< to be tried
  int finer = 1;                          ///< its steps are the problem's, divided by this
  std::function<std::unique_ptr<Stepper>(const BodyModel& model, double tolerance, const Threads& threads)> make = {};
};

/// Euler, BDF2 and Newmark, each linearised once (at the start or the predictor) or iterated to force balance.
std::vector<Method> softreel_schemes();

/// A scheme alone; `tolerance` is that of the linear solve, or of the force balance where it iterates.
SolverParams scheme_params(Integrator integrator, Linearize linearize, double tolerance);

/// softreel with other people's numerics: the paper's rotations and plain V-cycles, small strain, smoothed polar.
std::vector<Method> softreel_variants();

/// Other solvers of the same step, and other ways to animate.
std::vector<Method> rival_methods();

/// The three lists above, in this order.
std::vector<Method> all_methods();

/// One row a method: what it is and how it was tuned.
Table method_table(const std::vector<Method>& methods);

}  // namespace softreel::bench
