// Steps of a frame: fixed, chosen by their error, and left out at rest.
#include "core/dynamics/frame_steps.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;
using testing::greatest_distance;
using testing::kFps;

/// A bar that is held at one end and carried to the right and back down between frames 2 and 4.
BodyModel carried_bar(double damping_mass) {
  BodyModel model = body_model(testing::kuhn_bar({4, 1, 1}, Vec3(0.8, 0.2, 0.2)), {4e4, 0.3, 1000, damping_mass, 0.02});
  Transform away;
  away.translate = Vec3(0.2, 0.1, 0);
  Pin pin = testing::make_pin(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; }));
  pin.track = {{{2, {}, Ease::Smooth}, {4, away, Ease::Smooth}}};
  model.pins = {pin};
  return model;
}

SolverParams controlled(Integrator integrator, double step_error) {
  SolverParams params;
  params.integrator = integrator;
  params.linearize = Linearize::Predictor;
  params.tolerance = 1e-9;
  params.step_error = step_error;
  params.rest_tolerance = 0;
  return params;
}

struct Motion {
  int steps = 0, rejected = 0, at_rest = 0, parts = 0;
  std::vector<Vec3> positions;
  double shortest = 1;
};

Motion simulate(const BodyModel& model, const SolverParams& params, int frames) {
  Bench bench(model, params);
  Motion result;
  for (int frame = 1; frame <= frames; ++frame) {
    const FrameReport report = advance_to_frame(
        bench.simulator, frame, kFps, [] {}, [&](int) { ++result.parts; });
    EXPECT_TRUE(report.ok()) << frame;
    result.steps += report.steps;
    result.rejected += report.steps_rejected;
    result.at_rest += report.steps_at_rest;
    if (const double last = bench.simulator.state().previous_seconds; last > 0)
      result.shortest = std::min(result.shortest, last);
  }
  result.positions = bench.simulator.state().positions;
  return result;
}

TEST(FrameSteps, AreSubstepsOfEqualLengthUnlessErrorsAreControlled) {
  SolverParams params = controlled(Integrator::Bdf2, 0);
  params.substeps = 3;
  Bench bench(carried_bar(0), params), by_hand(carried_bar(0), params);
  std::vector<int> parts;
  int before = 0;
  const FrameReport report = advance_to_frame(
      bench.simulator, 1, kFps, [&] { ++before; }, [&](int part) { parts.push_back(part); });
  for (int s = 1; s <= 3; ++s) ASSERT_TRUE(by_hand.simulator.step(s / 3.0, 1 / (kFps * 3)).ok());
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.steps, 3);
  EXPECT_EQ(before, 3);
  EXPECT_EQ(parts, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(bench.simulator.state().positions, by_hand.simulator.state().positions);
}

/// The body after `frames`, as exactly as many short steps of second order make it.
SimulationState exact_state(const BodyModel& model, double frames) {
  SolverParams params = controlled(Integrator::Newmark, 0);
  Bench bench(model, params);
  const int steps = 512;
  for (int k = 1; k <= steps; ++k) EXPECT_TRUE(bench.simulator.step(frames * k / steps, frames / (kFps * steps)).ok());
  return bench.simulator.state();
}

TEST(StepError, IsEstimatedToAFactorOfTwo) {
  BodyModel model = carried_bar(0.5);
  model.pins[0].track = testing::constant(Transform{});
  const double h = 0.25;  // frames
  const SimulationState before = exact_state(model, 2 - h), at = exact_state(model, 2),
                        after = exact_state(model, 2 + h);
  for (const auto& [integrator, remembers] :
       {std::pair(Integrator::Euler, false), std::pair(Integrator::Bdf2, true), std::pair(Integrator::Bdf2, false),
        std::pair(Integrator::Newmark, false)}) {
    Bench bench(model, controlled(integrator, 1));
    SimulationState start = at;
    start.accelerations.clear();
    start.previous_seconds = 0;
    if (remembers) {
      start.previous_positions = before.positions;
      start.previous_velocities = before.velocities;
      start.previous_seconds = h / kFps;
    }
    bench.simulator.set_state(start);
    const StepReport rejected = bench.simulator.step(2 + h, h / kFps, 1e-12);
    EXPECT_TRUE(rejected.rejected);
    EXPECT_EQ(bench.simulator.state().positions, start.positions);
    EXPECT_TRUE(bench.simulator.state().accelerations.empty());
    const StepReport report = bench.simulator.step(2 + h, h / kFps, 1);
    EXPECT_EQ(report.error, rejected.error);
    const double size = Vec3(0.8, 0.2, 0.2).norm();
    const double error = greatest_distance(bench.simulator.state().positions, after.positions) / size;
    EXPECT_GT(report.error, 0.5 * error) << static_cast<int>(integrator) << remembers;
    EXPECT_LT(report.error, 2 * error) << static_cast<int>(integrator) << remembers;
  }
}

TEST(FrameSteps, GetShorterUntilTheErrorIsWhatWasAskedFor) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark}) {
    const BodyModel model = carried_bar(0.5);
    SolverParams fine = controlled(integrator, 0);
    fine.substeps = integrator == Integrator::Euler ? 2048 : 512;
    const std::vector<Vec3> exact = simulate(model, fine, 6).positions;
    double last_distance = 1;
    int last_steps = 0;
    for (const double step_error : {1e-3, 1e-4, 1e-5}) {
      const Motion found = simulate(model, controlled(integrator, step_error), 6);
      EXPECT_EQ(found.parts, 6) << "every frame is met";
      EXPECT_GT(found.steps, last_steps);
      EXPECT_LT(found.rejected, found.steps);
      const double distance = greatest_distance(found.positions, exact);
      EXPECT_LT(distance, 0.7 * last_distance) << step_error;
      EXPECT_LT(distance, 2 * found.steps * step_error) << "errors of steps at most add up, over a size of 0.85 m";
      last_distance = distance;
      last_steps = found.steps;
    }
  }
}

/// Pulled up at its free end by a pull that is on for three fifths of a frame: by its range, or by its strength.
BodyModel jolted_bar(bool by_range) {
  BodyModel model = carried_bar(0);
  model.gravity.setZero();
  model.pins[0].track = testing::constant(Transform{});
  Transform up;
  up.translate = Vec3(0, 0.3, 0);
  Pull pull =
      testing::make_pull(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() > 0.79; }), up, 500);
  if (by_range)
    pull.active = {{2.2, 2.8}};
  else
    pull.stiffness = {{{2.2, 0, Ease::Linear}, {2.5, 1000, Ease::Linear}, {2.8, 0, Ease::Linear}}};
  model.pulls = {pull};
  return model;
}

TEST(FrameSteps, DoNotJumpOverAPullThatIsShorterThanAStep) {
  for (const bool by_range : {true, false}) {
    const BodyModel model = jolted_bar(by_range);
    SolverParams fine = controlled(Integrator::Bdf2, 0);
    fine.substeps = 512;
    const std::vector<Vec3> exact = simulate(model, fine, 4).positions;
    const double jolt = greatest_distance(exact, model.mesh.nodes);
    EXPECT_GT(jolt, 0.01);
    for (const double rest_tolerance : {0.0, 1e-7}) {
      SolverParams params = controlled(Integrator::Bdf2, 1e-4);
      params.rest_tolerance = rest_tolerance;
      EXPECT_LT(greatest_distance(simulate(model, params, 4).positions, exact), 0.1 * jolt) << by_range;
    }
  }
}

TEST(FrameSteps, AreTheSameWhereConstraintsChangeAtFrames) {
  // Were steps to end there anyway, nothing is to be cut. (By Euler: BDF2 begins anew where a pull is switched.)
  BodyModel model = jolted_bar(true);
  model.pulls[0].active = {{2, 3}};
  model.pulls[0].track = {{{1, model.pulls[0].track.keys[0].value, Ease::Constant}, {3, {}, Ease::Constant}}};
  BodyModel always = model;
  always.pulls[0].active.clear();
  always.pulls[0].stiffness = {{{1, 0, Ease::Constant}, {2, 500, Ease::Constant}, {4, 0, Ease::Constant}}};
  const SolverParams params = controlled(Integrator::Euler, 1e-3);
  EXPECT_EQ(simulate(model, params, 3).positions, simulate(always, params, 3).positions);
  // Nothing is switched between two ranges of which one goes on where the other ends.
  BodyModel parted = model;
  parted.pulls[0].active = {{2, 2}, {3, 3}};
  const SolverParams remembering = controlled(Integrator::Bdf2, 1e-3);
  EXPECT_EQ(simulate(model, remembering, 3).positions, simulate(parted, remembering, 3).positions);
}

TEST(FrameSteps, GrowAgainWhereNothingMuchHappens) {
  BodyModel model = carried_bar(20);
  model.gravity.setZero();
  SolverParams params = controlled(Integrator::Bdf2, 1e-5);
  Bench bench(model, params);
  std::vector<int> steps;
  for (int frame = 1; frame <= 60; ++frame) {
    const FrameReport report = advance_to_frame(
        bench.simulator, frame, kFps, [] {}, [](int) {});
    ASSERT_TRUE(report.ok());
    steps.push_back(report.steps);
  }
  EXPECT_EQ(steps.front(), 1) << "at rest";
  EXPECT_GT(steps[2], 4) << "the pin moves";
  EXPECT_EQ(steps.back(), 1) << "at rest again";
}

TEST(FrameSteps, SayThatTheShortestStepIsTooLong) {
  BodyModel model = carried_bar(0);
  Transform away;
  away.translate = Vec3(0.2, 0.1, 0);
  model.pins[0].track = {{{0, {}, Ease::Constant}, {3, away, Ease::Constant}}};  // jumps
  SolverParams params = controlled(Integrator::Bdf2, 1e-4);
  params.max_substeps = 64;
  Bench bench(model, params);
  FrameReport report;
  for (int frame = 1; frame <= 3; ++frame)
    report = advance_to_frame(
        bench.simulator, frame, kFps, [] {}, [](int) {});
  EXPECT_TRUE(report.too_short);
  EXPECT_FALSE(report.ok());
  EXPECT_TRUE(report.last.ok()) << "it was solved";
  EXPECT_GT(report.last.error, 1e-4);
}

TEST(FrameSteps, ContinueAStoredFrameWithTheSameBitsUnderErrorControl) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark}) {
    const SolverParams params = controlled(integrator, 1e-4);
    Bench whole(carried_bar(0.5), params), resumed(carried_bar(0.5), params);
    int shorter = 0;
    for (int frame = 1; frame <= 6; ++frame) {
      if (frame == 4) resumed.simulator.set_state(whole.simulator.state());
      const FrameReport report = advance_to_frame(
          whole.simulator, frame, kFps, [] {}, [](int) {});
      shorter += report.steps > 1 ? 1 : 0;
      if (frame < 4) continue;
      const FrameReport again = advance_to_frame(
          resumed.simulator, frame, kFps, [] {}, [](int) {});
      EXPECT_EQ(again.steps, report.steps);
      EXPECT_EQ(again.steps_rejected, report.steps_rejected);
    }
    EXPECT_GT(shorter, 3);
    EXPECT_EQ(whole.simulator.state().positions, resumed.simulator.state().positions);
    EXPECT_EQ(whole.simulator.state().velocities, resumed.simulator.state().velocities);
  }
}

TEST(Rest, LeavesABodyInBalanceToTheLastBitUntilItsPinMoves) {
  Bench bench(carried_bar(1));
  ASSERT_TRUE(bench.simulator.find_equilibrium(1).ok());
  const SimulationState balanced = bench.simulator.state();
  const FrameReport still = advance_to_frame(
      bench.simulator, 2, kFps, [] {}, [](int) {});
  EXPECT_EQ(still.steps_at_rest, 1);
  EXPECT_EQ(still.linear_iterations, 0);
  EXPECT_EQ(bench.simulator.state().positions, balanced.positions);
  EXPECT_EQ(bench.simulator.state().velocities, balanced.velocities);
  for (std::size_t e = 0; e < balanced.rotations.size(); ++e)
    EXPECT_EQ(bench.simulator.state().rotations[e].coeffs(), balanced.rotations[e].coeffs());
  const FrameReport moving = advance_to_frame(
      bench.simulator, 3, kFps, [] {}, [](int) {});
  EXPECT_EQ(moving.steps_at_rest, 0);
  EXPECT_NE(bench.simulator.state().positions, balanced.positions);
}

TEST(Rest, EndsWhenAPullChanges) {
  BodyModel model = carried_bar(1);
  const std::vector<Index> end = testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() > 0.79; });
  Pull pull = testing::make_pull(end, {}, 20);
  pull.stiffness = {{{0, 20.0, Ease::Constant}, {4, 30.0, Ease::Constant}}};
  model.pins[0].track = testing::constant(Transform{});
  model.pulls = {pull};
  Bench bench(model);
  ASSERT_TRUE(bench.simulator.find_equilibrium(1).ok());
  const auto rests = [&](int frame) {
    return advance_to_frame(
               bench.simulator, frame, kFps, [] {}, [](int) {})
               .steps_at_rest == 1;
  };
  EXPECT_TRUE(rests(2));
  EXPECT_TRUE(rests(3));
  EXPECT_FALSE(rests(4));
}

TEST(Rest, IsNotTheTurnOfASwingNorABodyThatFalls) {
  SolverParams params;
  Bench falling(body_model(testing::kuhn_bar({2, 1, 1}, Vec3(0.4, 0.2, 0.2)), {4e4, 0.3, 1000, 0, 0}), params);
  EXPECT_FALSE(falling.simulator.step(1, 1 / kFps).at_rest);
  BodyModel model = body_model(testing::kuhn_bar({2, 1, 1}, Vec3(0.4, 0.2, 0.2)), {4e4, 0.3, 1000, 0, 0});
  model.gravity.setZero();
  Bench swinging(model, params);
  EXPECT_TRUE(swinging.simulator.step(1, 1 / kFps).at_rest) << "nothing acts";
  SimulationState stretched = swinging.simulator.state();
  for (Vec3& position : stretched.positions) position.x() *= 1.01;
  swinging.simulator.set_state(stretched);
  EXPECT_FALSE(swinging.simulator.step(2, 1 / kFps).at_rest) << "still, but not in balance";
}

TEST(Rest, IsNotThatOfALightPieceThatFallsBesideAHeavyOne) {
  const TetMesh statue = testing::kuhn_bar({2, 2, 2}, Vec3::Ones()),
                leaf = testing::kuhn_bar({2, 1, 1}, Vec3::Constant(0.1));
  const TetMesh both = testing::side_by_side(statue, leaf, Vec3(3, 0, 0));
  BodyModel model = body_model(both, {1e6, 0.3, 1e4, 0, 0});
  for (std::size_t e = statue.tets.size(); e < both.tets.size(); ++e) model.materials[e].density = 1;
  model.pins = {testing::make_pin(testing::select_nodes(both, [](const Vec3& p) { return p.x() < 2; }))};
  Bench bench(model);
  EXPECT_FALSE(bench.simulator.step(1, 1 / kFps).at_rest);
  for (std::size_t i = statue.nodes.size(); i < both.nodes.size(); ++i)
    EXPECT_NEAR(bench.simulator.state().positions[i].y() - both.nodes[i].y(), -9.81 / (kFps * kFps), 1e-6);
}

TEST(Rest, IsNotThatOfAFlakeThatIsLighterThanTheRoundingOfSteel) {
  const TetMesh steel = testing::kuhn_bar({20, 4, 4}, Vec3(1, 0.2, 0.2)),
                flake = testing::kuhn_bar({1, 1, 1}, Vec3::Constant(0.003));
  const TetMesh both = testing::side_by_side(steel, flake, Vec3(3, 0, 0));
  BodyModel model = body_model(both, {2e11, 0.3, 7800, 0, 0});
  for (std::size_t e = steel.tets.size(); e < both.tets.size(); ++e) model.materials[e] = {1e5, 0.3, 100, 0, 0};
  model.pins = {testing::make_pin(testing::select_nodes(both, [](const Vec3& p) { return p.x() < 2; }))};
  Bench bench(model);
  EXPECT_FALSE(bench.simulator.step(1, 1 / kFps).at_rest);
  EXPECT_NEAR(bench.simulator.state().positions.back().y() - both.nodes.back().y(), -9.81 / (kFps * kFps), 1e-6);
}

TEST(Rest, OfAFreeBodyDoesNotDependOnRounding) {
  BodyModel model = body_model(testing::kuhn_bar({3, 2, 1}, Vec3(0.7, 0.3, 0.1)), {4e4, 0.3, 1000, 0, 0});
  model.gravity.setZero();
  Bench bench(model);
  EXPECT_TRUE(bench.simulator.step(1, 1 / kFps).at_rest);
}

TEST(Rest, IsNotASlowDriftHoweverShortTheSteps) {
  BodyModel model = body_model(testing::kuhn_bar({2, 1, 1}, Vec3(0.5, 0.25, 0.25)), {4e4, 0.3, 1000, 0, 0});
  model.gravity.setZero();
  for (const int substeps : {1, 512}) {
    SolverParams params;
    params.substeps = substeps;
    Bench bench(model, params);
    SimulationState drifting = bench.simulator.state();
    for (Vec3& velocity : drifting.velocities) velocity = Vec3(0, 0, 5e-5);
    bench.simulator.set_state(drifting);
    EXPECT_TRUE(advance_to_frame(
                    bench.simulator, 1, kFps, [] {}, [](int) {})
                    .ok());
    for (std::size_t i = 0; i < model.mesh.nodes.size(); ++i)
      EXPECT_NEAR(bench.simulator.state().positions[i].z() - model.mesh.nodes[i].z(), 5e-5 / kFps, 1e-9) << substeps;
  }
}

TEST(Rest, ChangesNothingBeyondItsTolerance) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark}) {
    SolverParams stepped;
    stepped.integrator = integrator;
    stepped.rest_tolerance = 0;
    SolverParams skipped = stepped;
    skipped.rest_tolerance = 1e-6;
    skipped.force_tolerance = 1e-5;
    // Damped by 20 / s in its mass, it comes to rest within two seconds after its pin does.
    const Motion all = simulate(carried_bar(20), stepped, 240), some = simulate(carried_bar(20), skipped, 240);
    EXPECT_EQ(all.at_rest, 0);
    EXPECT_GT(some.at_rest, 60) << static_cast<int>(integrator);
    EXPECT_EQ(some.steps, all.steps);
    EXPECT_LT(greatest_distance(all.positions, some.positions), 3e-5);
  }
}

}  // namespace
}  // namespace softreel
