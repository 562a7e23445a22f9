// What damping of stiffness takes of a body that turns.
#include <gtest/gtest.h>

#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

/// Angular momentum of a free bar after a second of 1 / 2000 s a step. It turns at 6 rad/s, which makes it longer by a
/// tenth once it has come to rest in its own frame.
double spin_after_a_second(Integrator integrator, double damping_stiffness) {
  const TetMesh mesh = testing::kuhn_bar({4, 1, 1}, Vec3(0.8, 0.2, 0.2));
  BodyModel model = testing::body_model(mesh, {2e4, 0.3, 1000, 0, damping_stiffness});
  model.gravity = Vec3::Zero();
  SolverParams params;
  params.integrator = integrator;
  params.tolerance = 1e-8;
  testing::Bench bench(model, params);
  SimulationState state = bench.simulator.state();
  for (std::size_t i = 0; i < state.positions.size(); ++i)
    state.velocities[i] = Vec3(0, 0, 6).cross(state.positions[i] - Vec3(0.4, 0.1, 0.1));
  bench.simulator.set_state(state);
  for (int k = 1; k <= 2000; ++k) EXPECT_TRUE(bench.simulator.step(k, 1.0 / 2000).ok());
  return bench.simulator.measure().angular_momentum.z();
}

TEST(DampingOfStiffness, LeavesASpinAlone) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    const double undamped = spin_after_a_second(integrator, 0);
    EXPECT_NEAR(spin_after_a_second(integrator, 0.05), undamped, 0.005 * undamped) << static_cast<int>(integrator);
  }
}

}  // namespace
}  // namespace softreel
