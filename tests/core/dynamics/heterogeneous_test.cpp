/// Each element's E, nu, density and both dampings are used, in steps in float and in double.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;
using testing::greatest_distance;

/// Stretched, sheared and turning.
void set_in_motion(Simulator& simulator) {
  SimulationState state = simulator.state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    Vec3& p = state.positions[i];
    const double z = p.z() > 0.6 ? p.z() - 1 : p.z();
    state.velocities[i] = Vec3(0.5 + p.y(), -0.2 + 2 * p.x(), 3 * z);
    p = Vec3(1.1 * p.x() + 0.2 * p.y(), p.y(), p.z() + 0.1 * p.x());
  }
  simulator.set_state(state);
}

std::vector<Vec3> positions_after(const TetMesh& mesh, const std::vector<ElementMaterial>& materials,
                                  double tolerance) {
  BodyModel model = body_model(mesh, {});
  model.materials = materials;
  SolverParams params;
  params.tolerance = tolerance;
  Bench bench(model, params);
  set_in_motion(bench.simulator);
  for (int k = 1; k <= 8; ++k) EXPECT_TRUE(bench.simulator.step(k, 1.0 / 48).ok());
  return bench.simulator.state().positions;
}

TEST(HeterogeneousBody, MovesEachPieceAsIfItWereAlone) {
  const TetMesh mesh = testing::kuhn_bar({4, 2, 2}, Vec3(0.4, 0.2, 0.2)),
                both = testing::side_by_side(mesh, mesh, Vec3(0, 0, 1));
  const ElementMaterial plain{1e4, 0.3, 1000, 0.5, 0.005};
  std::vector<ElementMaterial> others(5, plain);
  others[0].youngs_modulus = 3e4;
  others[1].poisson_ratio = 0.45;
  others[2].density = 300;
  others[3].damping_mass = 3;
  others[4].damping_stiffness = 0.3;
  for (const double tolerance : {1e-6, 1e-12})  // in float and in double
    for (const ElementMaterial& other : others) {
      std::vector<ElementMaterial> materials(mesh.tets.size(), plain);
      const std::vector<Vec3> first = positions_after(mesh, materials, tolerance);
      materials.assign(mesh.tets.size(), other);
      const std::vector<Vec3> second = positions_after(mesh, materials, tolerance);
      materials.assign(mesh.tets.size(), plain);
      materials.resize(both.tets.size(), other);
      const std::vector<Vec3> together = positions_after(both, materials, tolerance);
      double error = 0, difference = 0;
      const std::size_t n = mesh.nodes.size();
      for (std::size_t i = 0; i < n; ++i) {
        error =
            std::max({error, (together[i] - first[i]).norm(), (together[n + i] - Vec3(0, 0, 1) - second[i]).norm()});
        difference = std::max(difference, (first[i] - second[i]).norm());
      }
      EXPECT_GT(difference, 2e-4) << "the two materials move differently";
      EXPECT_LT(error, std::max(3 * tolerance, 1e-10));
    }
}

/// A bar of steel that two pins press together by a hundredth, and one of jelly beside it.
struct PressedSteelAndJelly {
  TetMesh steel = testing::kuhn_bar({8, 2, 2}, Vec3(0.8, 0.2, 0.2));
  TetMesh jelly = testing::kuhn_bar({8, 2, 2}, Vec3(0.4, 0.1, 0.1));
  BodyModel alone = body_model(jelly, {1e4, 0.3, 1000, 0, 0});
  BodyModel both = body_model(testing::side_by_side(steel, jelly, Vec3(3, 0, 0)), {1e11, 0.3, 7800, 0, 0});

  PressedSteelAndJelly() {
    for (std::size_t e = steel.tets.size(); e < both.materials.size(); ++e) both.materials[e] = alone.materials[0];
    Transform press;
    press.translate = Vec3(-0.008, 0, 0);
    both.pins = {testing::make_pin(select([](const Vec3& p) { return p.x() < 0.01; })),
                 testing::make_pin(select([](const Vec3& p) { return p.x() > 0.79 && p.x() < 2; }), press)};
  }
  template <typename Predicate>
  std::vector<Index> select(const Predicate& takes) const {
    return testing::select_nodes(both.mesh, takes);
  }
  /// How far the jelly is from where it is by itself.
  double difference(const SimulationState& together, const SimulationState& by_itself) const {
    double greatest = 0;
    for (std::size_t i = 0; i < jelly.nodes.size(); ++i)
      greatest = std::max(greatest,
                          (together.positions[steel.nodes.size() + i] - Vec3(3, 0, 0) - by_itself.positions[i]).norm());
    return greatest;
  }
};

TEST(HeterogeneousBody, AForceThatIsNothingToTheSteelBendsTheJellyInStatics) {
  PressedSteelAndJelly bodies;
  bodies.both.gravity.setZero();
  bodies.alone.gravity.setZero();
  Transform up;
  up.translate = Vec3(0, 0.02, 0);
  bodies.alone.pins = {
      testing::make_pin(testing::select_nodes(bodies.jelly, [](const Vec3& p) { return p.x() < 0.01; }))};
  bodies.alone.pulls = {
      testing::make_pull(testing::select_nodes(bodies.jelly, [](const Vec3& p) { return p.x() > 0.39; }), up, 1.0)};
  bodies.both.pins.push_back(testing::make_pin(bodies.select([](const Vec3& p) { return p.x() > 2 && p.x() < 3.01; })));
  bodies.both.pulls = {testing::make_pull(bodies.select([](const Vec3& p) { return p.x() > 3.39; }), up, 1.0)};
  for (BodyModel* model : {&bodies.alone, &bodies.both}) model->pulls[0].active = {{2, 9}};
  Bench together(bodies.both), by_itself(bodies.alone);
  for (const int frame : {1, 2}) {
    ASSERT_TRUE(together.simulator.find_equilibrium(frame).ok());
    ASSERT_TRUE(by_itself.simulator.find_equilibrium(frame).ok());
  }
  const double bend = greatest_distance(by_itself.simulator.state().positions, bodies.jelly.nodes);
  EXPECT_GT(bend, 1e-3);
  EXPECT_LT(bodies.difference(together.simulator.state(), by_itself.simulator.state()), 1e-4 * bend);
}

TEST(HeterogeneousBody, JellyFallsBesideSteelUnderAMillionTimesItsWeightWithIteratedSteps) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Newmark}) {
    PressedSteelAndJelly bodies;
    SolverParams params;
    params.integrator = integrator;
    params.linearize = Linearize::Iterated;
    Bench together(bodies.both, params), by_itself(bodies.alone, params);
    for (int frame = 1; frame <= 6; ++frame) {
      ASSERT_TRUE(together.simulator.step(frame, 1.0 / 24).ok());
      ASSERT_TRUE(by_itself.simulator.step(frame, 1.0 / 24).ok());
    }
    const double fall = greatest_distance(by_itself.simulator.state().positions, bodies.jelly.nodes);
    EXPECT_GT(fall, 0.2);
    EXPECT_LT(bodies.difference(together.simulator.state(), by_itself.simulator.state()), 1e-5 * fall)
        << static_cast<int>(integrator);
  }
}

TEST(HeterogeneousBody, StepsWithContrastsScatteredOverItsElements) {
  // Copies of coarse nodes at these contrasts depend on each other: no level of them would be definite.
  BodyModel model = body_model(test_support::make_box({24, 6, 6}, 0.25 / 6), {2e4, 0.3, 1000, 0.1, 0.002});
  std::mt19937 random(7);
  for (ElementMaterial& material : model.materials)
    if (random() % 10 == 0) material.youngs_modulus *= 1e4;
  model.pins = {testing::make_pin(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; }))};
  Bench bench(model);
  for (int k = 1; k <= 2; ++k) {
    const StepReport report = bench.simulator.step(k, 1.0 / 96);
    EXPECT_TRUE(report.ok()) << report.solve.iterations << " iterations";
  }
}

/// A bar_of_blocks ten seconds after it was let go under its weight.
StateMeasures at_rest(double contrast, Linearize linearize) {
  SolverParams params;
  params.linearize = linearize;
  Bench bench(testing::bar_of_blocks(contrast), params);
  for (int k = 1; k <= 240; ++k) {
    const StepReport report = bench.simulator.step(k, 1 / testing::kFps);
    EXPECT_TRUE(report.ok()) << contrast << ": " << report.culprit;
    if (!report.ok()) break;
  }
  return bench.simulator.measure();
}

TEST(HeterogeneousBody, DampedBlocksOfAnyStiffnessBetweenSoftOnesComeToRest) {
  const StateMeasures expected = at_rest(1e4, Linearize::Iterated);
  for (const Linearize linearize : {Linearize::Start, Linearize::Iterated})
    for (const double contrast : {1e5, 1e6, 1e8}) {
      const StateMeasures found = at_rest(contrast, linearize);
      EXPECT_LT(found.kinetic_energy, 1e-6 * expected.elastic_energy) << contrast;
      EXPECT_NEAR(found.elastic_energy, expected.elastic_energy, 0.01 * expected.elastic_energy) << contrast;
    }
}

}  // namespace
}  // namespace softreel
