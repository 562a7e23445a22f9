// Steps of one solve on bodies whose tangent is far from the matrix of the step: they must not swing by themselves.
#include <algorithm>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/dynamics/simulator.h"
#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;

constexpr double kLength = 0.4;

/// An undamped block without weight, held at its ends, which pins have brought `stretch` times as far apart. Its first
/// frequency is about 30 steps of 1 / 24 s long, its last a fiftieth of one.
BodyModel held_block(double stretch, double poisson_ratio) {
  BodyModel model =
      body_model(testing::kuhn_bar({6, 4, 4}, Vec3(kLength, 0.25, 0.25)), {2e4, poisson_ratio, 1000, 0, 0});
  model.gravity.setZero();
  const auto end = [&](double x) {
    return testing::select_nodes(model.mesh, [x](const Vec3& p) { return std::abs(p.x() - x) < 1e-9; });
  };
  Transform apart;
  apart.translate = Vec3((stretch - 1) * kLength, 0, 0);
  model.pins = {testing::make_pin(end(0)), testing::make_pin(end(kLength), apart)};
  return model;
}

SolverParams one_solve(Integrator integrator) {
  SolverParams params;
  params.integrator = integrator;
  params.linearize = integrator == Integrator::Bdf2 ? Linearize::Predictor : Linearize::Start;
  params.recovery = false;
  params.rest_tolerance = 0;
  return params;
}

/// Energy of motion, over that of a little noise at the start: the greatest from the tenth step on.
double swing(Bench& bench, double stretch) {
  SolverParams iterated = one_solve(Integrator::Euler);
  iterated.linearize = Linearize::Iterated;
  Bench calm(bench.simulator.model(), iterated);
  SimulationState state = calm.simulator.state();
  for (Vec3& x : state.positions) x.x() *= stretch;
  calm.simulator.set_state(state);
  for (int k = 1; k <= 100; ++k) EXPECT_TRUE(calm.simulator.step(k, 1).ok());  // long steps: to its equilibrium
  state = calm.simulator.state();
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, 1e-3);
  for (Vec3& v : state.velocities) v = Vec3(normal(random), normal(random), normal(random));
  bench.simulator.set_state(state);
  const double start = bench.simulator.measure().kinetic_energy;
  double greatest = 0;
  for (int k = 1; k <= 200; ++k) {
    if (!bench.simulator.step(k, 1.0 / 24).ok()) return INFINITY;
    if (k >= 10) greatest = std::max(greatest, bench.simulator.measure().kinetic_energy);
  }
  return greatest / start;
}

TEST(OneSolve, LeavesABlockAtRestHoweverItIsHeld) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2})
    for (const double nu : {0.3, 0.45, 0.49})
      for (const double stretch : {0.6, 0.75, 1.0, 1.3, 1.7, 2.5, 4.0}) {
        Bench bench(held_block(stretch, nu), one_solve(integrator));
        EXPECT_LT(swing(bench, stretch), 1)
            << (integrator == Integrator::Bdf2 ? "BDF2" : "Euler") << ", nu " << nu << ", stretch " << stretch;
      }
}

}  // namespace
}  // namespace softreel
