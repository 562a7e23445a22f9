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
      "energy of the steps before. Drift: of momentum, over what the greatest kinetic energy allows. Flutter: how far "
      "an element turns in a step, by the rotation nearest to its deformation gradient, whatever the method's own is.");
  study_scrambles(options, report);
  report.say(
      "Iterated implicit Euler is not bound by theory to lose energy, as the energy is not convex. So each step is "
      "looked at; steps in which recovery acts are left out, because they are one solve.");
  study_iterated_energy(options, report);
  study_stretch(options, report);
  report.say(
      "A taut body resists by its tension, not by its bending. One solve a step whose matrix lacks that stiffness, as "
      "in the paper, lets a body flutter that is stiff, slender or far stretched for its step. The matrix of "
      "softreel's step has it, but for tension that is harmless by the body's thickness, stiffness and mass, so that "
      "other bodies cost nothing. BDF2 linearises at a predictor, which at large stretch still flutters where its step "
      "is long (`solver.substeps`).");
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
