/// What integrators make of the jump of the forces where a pin lets go: the body flies on as it flew.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;

constexpr double kFramesPerSecond = 24, kLetGo = 6;
const Vec3 kSpeed(2, 1, 0);  // m/s

/// A bar, all of whose surface is carried along until frame 6.
BodyModel carried_bar(const std::array<Index, 3>& cells, const ElementMaterial& material, const Vec3& gravity) {
  const Vec3 size(0.8, 0.2, 0.2);
  BodyModel model = body_model(testing::kuhn_bar(cells, size), material);
  model.gravity = gravity;
  Pin pin = testing::make_pin(testing::select_nodes(
      model.mesh, [&](const Vec3& p) { return ((p.array() < 1e-9) || (p.array() > size.array() - 1e-9)).any(); }));
  Transform far;
  far.translate = 2 * kSpeed;
  pin.track = {{{0, {}, Ease::Linear}, {2 * kFramesPerSecond, far, Ease::Linear}}};
  pin.active = {{0, kLetGo}};
  model.pins = {pin};
  return model;
}

void run_to(Bench& bench, double from, double to, int steps_per_frame) {
  const int steps = static_cast<int>((to - from) * steps_per_frame);
  for (int k = 1; k <= steps; ++k) {
    const StepReport report =
        bench.simulator.step(from + static_cast<double>(k) / steps_per_frame, 1 / (kFramesPerSecond * steps_per_frame));
    ASSERT_TRUE(report.ok()) << report.culprit;
  }
}

/// The inside, which is not held, rings when the pins begin to move: pins push it to and fro when they let go.
TEST(LettingGo, GivesNoPush) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark})
    for (const int steps : {1, 4, 16}) {
      SolverParams params = testing::exact_params();
      params.integrator = integrator;
      Bench bench(carried_bar({8, 4, 4}, {1e6, 0.3, 1000, 0, 0}, Vec3::Zero()), params);
      run_to(bench, 0, kLetGo, steps);
      const Vec3 before = bench.simulator.measure().linear_momentum;
      ASSERT_GT(before.norm(), 30);
      run_to(bench, kLetGo, kLetGo + 3, steps);
      EXPECT_LT((bench.simulator.measure().linear_momentum - before).norm(), 1e-6 * before.norm())
          << static_cast<int>(integrator) << ", " << steps << " steps a frame";
    }
}

/// Between the throw and where it is half a second later, of a bar whose nodes are all held until then, m.
double error_of_throw(Integrator integrator, int steps) {
  SolverParams params = testing::exact_params();
  params.integrator = integrator;
  Bench bench(carried_bar({4, 1, 1}, {1e5, 0.3, 1000, 0, 0}, Vec3(0, -9.81, 0)), params);
  const Vec3 start = bench.simulator.state().positions.front();
  run_to(bench, 0, kLetGo + 12, steps);
  const double flown = 12 / kFramesPerSecond, time = kLetGo / kFramesPerSecond + flown;
  const Vec3 exact = start + time * kSpeed - Vec3(0, 9.81 * flown * flown / 2, 0);
  return (bench.simulator.state().positions.front() - exact).norm();
}

TEST(LettingGo, LeavesIntegratorsTheirOrder) {
  EXPECT_LT(error_of_throw(Integrator::Newmark, 1), 1e-9);
  EXPECT_LT(error_of_throw(Integrator::Bdf2, 1), 1e-9);
  EXPECT_NEAR(error_of_throw(Integrator::Euler, 2) / error_of_throw(Integrator::Euler, 4), 2, 0.1);
}

/// Share of the kinetic energy of a spin that eight steps after the first have left it short of.
double taken_of_spin(Linearize linearize, double youngs_modulus, double turn) {
  SolverParams params = testing::exact_params();
  params.integrator = Integrator::Bdf2;
  params.linearize = linearize;
  BodyModel model = body_model(testing::kuhn_bar({4, 4, 1}, Vec3(0.2, 0.2, 0.05)), {youngs_modulus, 0.3, 1000, 0, 0});
  model.gravity.setZero();
  Bench bench(std::move(model), params);
  SimulationState state = bench.simulator.state();
  constexpr double kSeconds = 0.01;
  for (std::size_t i = 0; i < state.positions.size(); ++i)
    state.velocities[i] = Vec3(0, 0, turn / kSeconds).cross(state.positions[i] - Vec3(0.1, 0.1, 0.025));
  bench.simulator.set_state(state);
  const double before = bench.simulator.measure().kinetic_energy;
  for (int k = 1; k <= 9; ++k) EXPECT_TRUE(bench.simulator.step(k, kSeconds).ok());
  return 1 - bench.simulator.measure().kinetic_energy / before;
}

/// By the recurrence of a point on a rod without mass, two stages and eight steps take 0.1 of the square of a turn of
/// 0.1, and did the first take one stage, 2.5.
TEST(LettingGo, TakesLittleOfASpin) {
  for (const Linearize linearize : {Linearize::Predictor, Linearize::Iterated})
    for (const double youngs_modulus : {1e7, 1e8}) {
      const double taken = taken_of_spin(linearize, youngs_modulus, 0.1);
      RecordProperty(fmt::format("taken {:g}", youngs_modulus), fmt::format("{:.3g}", taken));
      EXPECT_LT(std::abs(taken), 0.3 * 0.1 * 0.1) << youngs_modulus;
    }
}

/// A bar on its pin, and a pull of a stiffness at a frame in a range.
std::vector<Vec3> pulled_positions(Integrator integrator, const Track<double>& stiffness, const FrameRange& range) {
  SolverParams params = testing::exact_params();
  params.integrator = integrator;
  BodyModel model = carried_bar({4, 1, 1}, {1e5, 0.3, 1000, 0, 0}, Vec3(0, -9.81, 0));
  model.pins[0].points = {0};
  model.pins[0].active.clear();
  Pull pull;
  pull.points = {static_cast<Index>(model.surface_points.size()) - 1};
  pull.weights = {1};
  pull.track.keys = {{0, {}, Ease::Linear}};
  pull.stiffness = stiffness;
  pull.active = {range};
  model.pulls = {pull};
  Bench bench(std::move(model), params);
  run_to(bench, 0, 12, 2);
  return bench.simulator.state().positions;
}

TEST(LettingGo, OfWhatHasNoStrengthIsNoJump) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark}) {
    const Track<double> none{{{0, 0, Ease::Linear}}}, some{{{0, 10, Ease::Linear}}},
        swell{{{4, 0, Ease::Linear}, {5, 10, Ease::Linear}, {7, 10, Ease::Linear}, {8, 0, Ease::Linear}}};
    const auto moved = [&](const Track<double>& stiffness, const FrameRange& range) {
      return pulled_positions(integrator, stiffness, range);
    };
    EXPECT_EQ(moved(none, {3, 9}), moved(none, {5, 6}));
    EXPECT_EQ(moved(swell, {3, 9}), moved(swell, {4, 8}));
    EXPECT_NE(moved(some, {3, 9}), moved(some, {4, 9}));
  }
}

/// A step that is not taken leaves what the state remembers.
TEST(LettingGo, IsForgottenWithARejectedStep) {
  for (const Integrator integrator : {Integrator::Bdf2, Integrator::Newmark}) {
    SolverParams params = testing::exact_params();
    params.integrator = integrator;
    Bench bench(carried_bar({8, 4, 4}, {1e6, 0.3, 1000, 0, 0}, Vec3(0, -9.81, 0)), params);
    run_to(bench, 0, kLetGo, 4);
    const SimulationState before = bench.simulator.state();
    ASSERT_TRUE(bench.simulator.step(kLetGo + 0.25, 1 / (4 * kFramesPerSecond), 1e-15).rejected);
    EXPECT_EQ(bench.simulator.state().accelerations, before.accelerations);
    EXPECT_EQ(bench.simulator.state().previous_positions, before.previous_positions);
    EXPECT_EQ(bench.simulator.state().constraints, before.constraints);
  }
}

}  // namespace
}  // namespace softreel
