#include "tests/benchmark/precision/moving_bars.h"

#include <fmt/format.h>

#include "tests/benchmark/precision/bar_motions.h"
#include "tests/benchmark/precision/beam_theory.h"

namespace softreel::bench {
namespace {

void append(std::vector<WorkPoint>& points, const std::vector<WorkPoint>& more) {
  points.insert(points.end(), more.begin(), more.end());
}

}  // namespace

ProblemResult measure_vibration(bool quick) {
  ProblemResult result{"vibration", "First bending frequency of a cantilever against Timoshenko's", "", {}, {}, {}};
  result.text = fmt::format(
      "The cantilever of the first problem swings after its weight (1e-4 of the usual) is switched on; its "
      "frequency is that of the period from the first to the third zero of its velocity. Truth: Timoshenko's frequency "
      "with shear and rotary inertia, {:.5f} Hz (Euler and Bernoulli: {:.5f}). The mesh is the greater part of the "
      "error: linear tetrahedra are too stiff in bending, and half the error of the "
      "stiffness is the frequency's. What stops short of its equations (XPBD, projective dynamics) is too soft, and "
      "where both errors cancel looks better than it is.",
      timoshenko_frequency({}), euler_bernoulli_frequency({}));
  std::vector<Method> methods = all_methods();
  for (Method& method : methods)
    if (method.tolerances.size() > 1) method.tolerances = {method.tolerances[1]};
  Pace pace;
  for (const Index across : quick ? std::vector<Index>{1, 2, 4} : std::vector<Index>{2, 4, 6, 8}) {
    MotionProblem problem = vibration_problem(across);
    problem.steps = halved_frames(quick ? 2 : 3);
    problem.most_seconds = quick ? 0.3 : 3;
    append(result.points, sweep(problem, methods, pace));
  }
  result.orders.push_back(order_in_mesh(result.points, "Newmark, predictor", 2));
  return result;
}

ProblemResult measure_drop(bool quick) {
  ProblemResult result{"drop", "A bar dropped and caught by its pins: motion against that of the same mesh", "", {}, {},
                       {}};
  result.text =
      "The targets' bar (1 x 0.25 x 0.25 m, E = 1e6 Pa, nu = 0.4, 1000 kg/m^3) under its weight. Its clamped end falls "
      "freely, is slowed down (3 t^2 - 2 t^3) and stops after 10 frames of 24, 0.28 m lower; the bar swings on until "
      "frame 14. Damping 0.1 / s of mass, none of stiffness, so that all methods solve one equation. Truth: the same "
      "mesh by iterated Newmark in steps a quarter of the shortest; so this is the error of time alone. Small strain, "
      "smoothed polar rotations and those of the paper are other materials and end at their difference. The stop is a "
      "jump in the acceleration of the pins, which sends a wave through the bar; no scheme has all of its second order "
      "there.";
  MotionProblem problem = drop_problem(quick ? 2 : 4, quick ? 5 : 6);
  problem.most_seconds = quick ? 0.5 : 6;
  Pace pace;
  result.points = sweep(problem, all_methods(), pace);
  for (const auto& [method, order] :
       {std::pair("Euler, start", 1), std::pair("Euler, iterated", 1), std::pair("BDF2, start", 1),
        std::pair("BDF2, predictor", 2), std::pair("BDF2, iterated", 2), std::pair("Newmark, start", 1),
        std::pair("Newmark, predictor", 2), std::pair("Newmark, iterated", 2)})
    result.orders.push_back(order_in_step(result.points, method, order));
  return result;
}

ProblemResult measure_settling(bool quick) {
  ProblemResult result{
      "settling", "A damped bar comes to rest: tip against the equilibrium of its own mesh", "", {}, {}, {}};
  result.text =
      "The targets' bar under its weight, damped by 16 / s of mass (about critical), looked at after 2 s. Truth: the "
      "same mesh's equilibrium to 1e-9, so that only the method's own idea of rest counts, "
      "and what its iterations leave undone.";
  MotionProblem problem = settling_problem(quick ? 2 : 4);
  problem.most_seconds = quick ? 0.5 : 4;
  if (quick) problem.steps.pop_back();
  Pace pace;
  result.points = sweep(problem, all_methods(), pace);
  return result;
}

}  // namespace softreel::bench
