// Steps of one solve on bodies whose tangent is far from the matrix of the step: they must not swing by themselves.
#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/dynamics/simulator.h"
#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;

constexpr double kLength = 0.4;

/// A block without weight, held at its ends, which pins have brought `stretch` times as far apart. At rest its longest
/// period is several steps of 1 / 24 s, its shortest a small part of one.
BodyModel held_block(double stretch, double poisson_ratio, double damping_stiffness) {
  BodyModel model = body_model(testing::kuhn_bar({6, 4, 4}, Vec3(kLength, 0.25, 0.25)),
                               {2e4, poisson_ratio, 1000, 0, damping_stiffness});
  model.gravity.setZero();
  const auto end = [&](double x) {
    return testing::select_nodes(model.mesh, [x](const Vec3& p) { return std::abs(p.x() - x) < 1e-9; });
  };
  Transform apart;
  apart.translate = Vec3((stretch - 1) * kLength, 0, 0);
  model.pins = {testing::make_pin(end(0)), testing::make_pin(end(kLength), apart)};
  return model;
}

SolverParams stepping(Integrator integrator, Linearize linearize) {
  SolverParams params;
  params.integrator = integrator;
  params.linearize = linearize;
  params.recovery = false;
  params.rest_tolerance = 0;
  return params;
}

/// The block's equilibrium, with a little noise of its velocities, m/s.
SimulationState disturbed(const BodyModel& model, double stretch, double noise) {
  Bench calm(model, stepping(Integrator::Euler, Linearize::Iterated));
  SimulationState state = calm.simulator.state();
  for (Vec3& x : state.positions) x.x() *= stretch;
  calm.simulator.set_state(state);
  for (int k = 1; k <= 100; ++k) EXPECT_TRUE(calm.simulator.step(k, 1).ok());  // long steps
  state = calm.simulator.state();
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, noise);
  for (Vec3& v : state.velocities) v = Vec3(normal(random), normal(random), normal(random));
  return state;
}

/// Energy of motion, over that of the disturbance: the greatest from the tenth step on.
double swing(Bench& bench, double stretch) {
  bench.simulator.set_state(disturbed(bench.simulator.model(), stretch, 1e-3));
  const double start = bench.simulator.measure().kinetic_energy;
  double greatest = 0;
  for (int k = 1; k <= 120; ++k) {
    if (!bench.simulator.step(k, 1.0 / 24).ok()) return INFINITY;
    if (k >= 10) greatest = std::max(greatest, bench.simulator.measure().kinetic_energy);
  }
  return greatest / start;
}

TEST(OneSolve, LeavesABlockAtRestHoweverItIsHeld) {
  struct Scheme {
    const char* name;
    Integrator integrator;
    Linearize linearize;
    double damping_stiffness;
  };
  for (const Scheme& scheme : {Scheme{"Euler", Integrator::Euler, Linearize::Start, 0},
                               {"Euler from its predictor", Integrator::Euler, Linearize::Predictor, 0},
                               {"BDF2", Integrator::Bdf2, Linearize::Predictor, 0},
                               {"damped BDF2", Integrator::Bdf2, Linearize::Predictor, 0.02}})
    for (const double nu : {0.3, 0.49})
      for (const double stretch : {0.6, 0.75, 1.7, 2.5, 4.0}) {
        Bench bench(held_block(stretch, nu, scheme.damping_stiffness), stepping(scheme.integrator, scheme.linearize));
        EXPECT_LT(swing(bench, stretch), 1) << scheme.name << ", nu " << nu << ", stretch " << stretch;
      }
}

/// Where a body at the limit of its dilatation hardly moves, the steps of a frame keep their matrix.
TEST(OneSolve, KeepsTheMatrixOfABodyAtTheLimitThatHardlyMoves) {
  Bench bench(held_block(2.5, 0.49, 0.02), stepping(Integrator::Bdf2, Linearize::Predictor));
  bench.simulator.set_state(disturbed(bench.simulator.model(), 2.5, 1e-6));
  double kept = 0;
  constexpr int kSteps = 8;
  for (int k = 1; k <= kSteps; ++k) kept += bench.simulator.step(k / 100.0, 1.0 / 24).kept_rows;
  EXPECT_GT(kept, 0.9 * (kSteps - 2)) << "the first step is of two stages, the second has no system before it";
}

/// Where BDF2 linearises, a body that spins is stretched by three quarters of the square of its turn in a step. The
/// tension of that is none, and must not brake it: BDF2 itself takes about the fourth power of the turn a step. And
/// rotations lag there by half the third power, which must not speed it up.
TEST(OneSolve, TakesNoMoreOfASpinThanItsIntegratorAndAddsNothing) {
  constexpr double kTurn = 0.13;  // rad a step
  for (const double youngs_modulus : {1e5, 1e6, 1e7}) {
    BodyModel model = body_model(testing::kuhn_bar({4, 4, 1}, Vec3(0.2, 0.2, 0.05)), {youngs_modulus, 0.3, 1000, 0, 0});
    model.gravity.setZero();
    Bench bench(std::move(model), stepping(Integrator::Bdf2, Linearize::Predictor));
    SimulationState state = bench.simulator.state();
    constexpr double kSeconds = 1.0 / 96;
    for (std::size_t i = 0; i < state.positions.size(); ++i)
      state.velocities[i] = Vec3(0, 0, kTurn / kSeconds).cross(state.positions[i] - Vec3(0.1, 0.1, 0.025));
    bench.simulator.set_state(state);
    const auto energy_after = [&](int steps) {
      for (int k = 0; k < steps; ++k) EXPECT_TRUE(bench.simulator.step(1, kSeconds).ok());
      return bench.simulator.measure().kinetic_energy;
    };
    const double start = energy_after(16);  // what rings at first dies away
    constexpr int kSteps = 384;
    const double kept = energy_after(kSteps) / start;
    RecordProperty(fmt::format("kept {:g}", youngs_modulus), fmt::format("{:.4f}", kept));
    EXPECT_GT(kept, 1 - kSteps * std::pow(kTurn, 4)) << youngs_modulus;
    EXPECT_LT(kept, 1 + 0.1 * kSteps * std::pow(kTurn, 4)) << youngs_modulus << ": it speeds up by itself";
  }
}

}  // namespace
}  // namespace softreel
