#include "tests/benchmark/stability/scramble_study.h"

#include <algorithm>
#include <random>

#include <fmt/format.h>

#include "core/constraints/pins.h"
#include "tests/support/bcc_bar.h"

namespace softreel::bench {
namespace {

constexpr double kStep = 1.0 / 24;

/// The nodes as thrown; those in `keep` where they were.
void throw_about(Simulator& simulator, const testing::Scramble& scramble, int seed, const std::vector<Index>& keep) {
  SimulationState state = simulator.state();
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  state.positions = scramble.positions(simulator.model().mesh.nodes, random);
  for (const Index node : keep)
    state.positions[static_cast<std::size_t>(node)] = simulator.model().mesh.nodes[static_cast<std::size_t>(node)];
  simulator.set_state(std::move(state));
}

/// Runs of one method from one kind of scramble.
struct ScrambleSums {
  int back = 0, recovered = 0, steps = 0, not_numbers = 0, unsolved = 0;
  double worst_gain = 0, angular_drift = 0;
  long inverted = 0, wound = 0;

  void add(const ScrambledRun& run) {
    back += run.came_back ? 1 : 0;
    recovered += run.recovered ? 1 : 0;
    steps += run.came_back ? run.verdict.steps : 0;
    not_numbers += run.verdict.finite ? 0 : 1;
    unsolved += run.verdict.unsolved() ? 1 : 0;
    worst_gain = std::max(worst_gain, run.verdict.worst_gain);
    angular_drift = std::max(angular_drift, run.verdict.angular_drift);
    inverted += run.left.inverted;
    wound += run.left.wound;
  }
};

Table scramble_table(int seeds, int most_steps) {
  return {"stability_scrambles",
          fmt::format("Free bodies released from {} seeds of each scramble, {} steps of 1/24 s at most: back is within "
                      "1e-3 of the body's size of the rest shape up to a rigid motion",
                      seeds, most_steps),
          {"start", "rotation", "recovery", "back %", "mean steps", "recovery acted", "NaN", "not solved",
           "worst energy gain", "angular drift", "elements left inverted", "elements left wound"},
          {}};
}

}  // namespace

ScrambledRun run_scramble(Index across, const testing::Scramble& scramble, RotationMethod rotation, bool recovery,
                          int seed, int most_steps) {
  SolverParams params;
  params.rotation = rotation;
  params.recovery = recovery;
  Rig rig(testing::scramble_model(across), params);
  throw_about(rig.simulator, scramble, seed, {});
  Watch watch(rig.simulator);
  ScrambledRun run;
  const std::vector<Vec3>& rest = rig.simulator.model().mesh.nodes;
  for (int k = 1; k <= most_steps && !run.came_back && watch.step(k, kStep); ++k) {
    run.recovered = run.recovered || watch.last().recovery.elements > 0;
    run.came_back = testing::is_back(rest, rig.simulator.state().positions);
  }
  run.verdict = watch.verdict();
  run.left = find_leftovers(rig.simulator);
  return run;
}

void study_scrambles(const BenchOptions& options, Report& report) {
  const int seeds = options.quick ? 3 : 50, most_steps = options.quick ? 200 : 400;
  const Index across = options.quick ? 2 : 3;
  Table table = scramble_table(seeds, most_steps);
  for (const testing::Scramble& scramble : testing::scrambles())
    for (const NamedMethod& method : kMethods)
      for (const bool recovery : {true, false}) {
        if (recovery && method.rotation == RotationMethod::None) continue;  // nothing to share
        ScrambleSums sums;
        for (int seed = 1; seed <= seeds; ++seed)
          sums.add(run_scramble(across, scramble, method.rotation, recovery, seed, most_steps));
        table.add(
            {scramble.name, method.name, recovery ? "on" : "off", 100.0 * sums.back / seeds,
             sums.back > 0 ? static_cast<double>(sums.steps) / sums.back : std::numeric_limits<double>::quiet_NaN(),
             long{sums.recovered}, long{sums.not_numbers}, long{sums.unsolved}, sums.worst_gain, sums.angular_drift,
             sums.inverted, sums.wound});
      }
  report.add(table);
}

EnergyRun run_iterated(Index across, const testing::Scramble& scramble, bool pinned, bool damped, int seed, int steps) {
  SolverParams params;
  params.linearize = Linearize::Iterated;
  BodyModel model = testing::scramble_model(across);
  if (!damped)
    for (ElementMaterial& material : model.materials) material.damping_mass = material.damping_stiffness = 0;
  std::vector<Index> held;
  if (pinned) {
    const std::vector<Index> side = testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; });
    model.pins = {{"body.box.pin[0]", side, {{{0, Transform{}, Ease::Constant}}}, {}}};
    const PinnedNodes nodes = NodePins(model.pins, model.embedding, model.mesh).at(0);
    for (std::size_t i = 0; i < nodes.held.size(); ++i)
      if (nodes.held[i] != 0) held.push_back(static_cast<Index>(i));
  }
  Rig rig(std::move(model), params);
  throw_about(rig.simulator, scramble, seed, held);
  Watch watch(rig.simulator);
  EnergyRun run;
  for (int k = 1; k <= steps && watch.step(k, kStep, false, false); ++k)
    run.judged += watch.last().recovery.elements == 0 ? 1 : 0;
  run.verdict = watch.verdict();
  return run;
}

void study_iterated_energy(const BenchOptions& options, Report& report) {
  const int seeds = options.quick ? 2 : 50, steps = options.quick ? 30 : 60;
  Table table{"stability_iterated_energy",
              fmt::format("Iterated implicit Euler from {} seeds of each scramble, {} steps of 1/24 s: steps outside "
                          "recovery that gained more than {:g} of the greatest energy before",
                          seeds, steps, kNoise),
              {"start", "pins", "damping", "steps judged", "steps that gained", "worst gain", "not solved"},
              {}};
  for (const testing::Scramble& scramble : testing::scrambles())
    for (const bool pinned : {false, true})
      for (const bool damped : {true, false}) {
        long judged = 0, gains = 0, broken = 0;
        double worst = 0;
        for (int seed = 1; seed <= seeds; ++seed) {
          const EnergyRun run = run_iterated(2, scramble, pinned, damped, seed, steps);
          judged += run.judged;
          gains += run.verdict.gains;
          broken += run.verdict.survived() ? 0 : 1;
          worst = std::max(worst, run.verdict.worst_gain);
        }
        table.add({scramble.name, pinned ? "low x side" : "none", damped ? "yes" : "no", judged, gains, worst, broken});
      }
  report.add(table);
}

}  // namespace softreel::bench
