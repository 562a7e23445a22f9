#include "tests/benchmark/stability/stability.h"

#include "tests/benchmark/stability/abuse_study.h"
#include "tests/benchmark/stability/pose_study.h"
#include "tests/benchmark/stability/scramble_study.h"

namespace softreel::bench {

void run_stability(const BenchOptions& options, Report& report) {
  report.say(
      "Every run is softreel's own simulator at its defaults (implicit Euler, one solve a step to 1e-3, 24 steps a "
      "second, cap on the dilatation stress, recovery) but for what a table names. `none` is small strain: its rest "
      "shape cannot turn, so a scrambled body that ends turned is never its rest shape up to a rigid motion, and it "
      "holds no turns. Energy gain: of a step in which pins do no work, over the greatest kinetic, elastic and pull "
      "energy of the steps before. Drift: of momentum, over what the greatest kinetic energy allows.");
  study_scrambles(options, report);
  report.say(
      "Iterated implicit Euler is not bound by theory to lose energy, as the energy is not convex. So each step is "
      "looked at; steps in which recovery acts are left out, because they are one solve.");
  study_iterated_energy(options, report);
  study_stretch(options, report);
  report.say(
      "One solve a step takes the stiffness that tension adds to a body from the step before, so a stiff, slender or "
      "far stretched body flutters where a step is long for its tension: the flutter is bounded, but the body does not "
      "come to rest. The remedies are `solver.substeps` and `solver.linearize = \"iterated\"`, as this table shows.");
  study_one_solve(options, report);
  report.say(
      "A layer of tetrahedra lets go of a whole turn once its two sides are turned too far against each other, and "
      "then "
      "every further turn slips there: a bar of more layers holds more turns.");
  study_twist(options, report);
  study_abuse(options, report);
  study_long_runs(options, report);
}

}  // namespace softreel::bench
