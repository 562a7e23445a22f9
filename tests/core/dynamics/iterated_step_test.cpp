// Steps that are iterated to force balance, and the potential that they minimise.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/dynamics/simulator.h"
#include "core/dynamics/step_potential.h"
#include "core/elasticity/mass.h"
#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/scrambled.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;
using testing::exact_params;

TetMesh thin_iterated_bar() {
  return testing::kuhn_bar({4, 1, 1}, Vec3(0.8, 0.2, 0.2));
}

SolverParams iterated_params(Integrator integrator = Integrator::Euler) {
  SolverParams params = exact_params();
  params.force_tolerance = 1e-10;
  params.integrator = integrator;
  params.linearize = Linearize::Iterated;
  return params;
}

BodyModel pinned_bar(double damping_stiffness = 0) {
  BodyModel model = body_model(thin_iterated_bar(), {2e4, 0.3, 1000, 0, damping_stiffness});
  model.pins = {testing::make_pin(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; }))};
  return model;
}

std::vector<Vec3> random_vectors(std::size_t count, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec3> vectors;
  for (std::size_t i = 0; i < count; ++i)
    vectors.push_back(size * Vec3(normal(random), normal(random), normal(random)));
  return vectors;
}

/// Damped from a stretch that is neither that of the present shape nor along its axes.
TEST(StepPotential, HasItsForcesAsGradient) {
  const TetMesh mesh = thin_iterated_bar();
  const std::size_t n = mesh.nodes.size(), elements = mesh.tets.size();
  const Threads threads(1);
  const ElasticBody body = make_elastic_body(mesh, std::vector<ElementMaterial>(elements), Dilatation::Capped);
  for (const RotationMethod method : {RotationMethod::Consistent, RotationMethod::None, RotationMethod::Qr}) {
    StepPotential potential{std::vector<double>(n, 3.0), random_vectors(n, 1, 1), {}};
    const std::vector<Quaternion> guesses(elements, Quaternion::Identity());
    const auto shifted = [&](double size, unsigned seed) {
      std::vector<Vec3> positions = random_vectors(n, size, seed);
      for (std::size_t i = 0; i < n; ++i)
        positions[i] += Vec3(-mesh.nodes[i].y(), mesh.nodes[i].x(), mesh.nodes[i].z());
      return positions;
    };
    potential.damping = {std::vector<double>(elements, 0.7), std::vector<double>(elements, 4e5),
                         find_stretches(body, method, shifted(0.02, 4), guesses, threads), method};
    const std::vector<Vec3> positions = shifted(0.03, 2), direction = random_vectors(n, 0.1, 3);
    std::vector<Vec3> forces(n), unused(n), moved(n);
    const auto energy_at = [&](double step, std::span<Vec3> forces_there) {
      for (std::size_t i = 0; i < n; ++i) moved[i] = positions[i] + step * direction[i];
      std::vector<Quaternion> rotations = guesses;
      find_rotations(body, method, moved, rotations, threads);
      return potential.evaluate(body, moved, rotations, forces_there, threads).value;
    };
    energy_at(0, forces);
    double slope = 0;
    for (std::size_t i = 0; i < n; ++i) slope -= forces[i].dot(direction[i]);
    EXPECT_NEAR((energy_at(1e-5, unused) - energy_at(-1e-5, unused)) / 2e-5, slope, 1e-6 * std::abs(slope));
  }
}

/// Elastic forces, weight and inertia of the step from `before` on free nodes, N: what implicit Euler makes zero.
TEST(IteratedStep, BalancesAllForcesAtItsEnd) {
  const double h = 1.0 / 24;
  const BodyModel model = pinned_bar();
  Bench bench(model, iterated_params());
  for (int k = 1; k <= 5; ++k) {
    const SimulationState before = bench.simulator.state();
    const StepReport report = bench.simulator.step(k, h);
    ASSERT_TRUE(report.ok()) << report.culprit;
    EXPECT_GT(report.nonlinear_iterations, 1);
    const SimulationState& after = bench.simulator.state();
    const ElasticBody body = make_elastic_body(model.mesh, model.materials, Dilatation::Capped);
    const NodalMasses masses = lump_masses(model.mesh, model.materials);
    std::vector<Quaternion> rotations = after.rotations;
    std::vector<Mat3> stresses(rotations.size());
    std::vector<Vec3> forces(after.positions.size());
    find_rotations(body, RotationMethod::Consistent, after.positions, rotations, bench.threads);
    find_stresses(body, after.positions, rotations, stresses, bench.threads);
    gather_forces(body, stresses, forces, bench.threads);
    for (std::size_t i = 0; i < forces.size(); ++i) {
      if (after.positions[i] == model.mesh.nodes[i]) continue;  // pinned
      const Vec3 inertia = masses.mass[i] / h * (after.velocities[i] - before.velocities[i]);
      const Vec3 weight = masses.mass[i] * model.gravity;
      EXPECT_LT((forces[i] + weight - inertia).norm(), 1e-7 * weight.norm());
    }
  }
}

TEST(IteratedStep, ReachesTheStaticShapeInOneEndlessStep) {
  Bench dynamic(pinned_bar(), iterated_params()), still(pinned_bar(), iterated_params());
  ASSERT_TRUE(dynamic.simulator.step(1, 1e6).ok());
  ASSERT_TRUE(still.simulator.find_equilibrium(1).ok());
  double sag = 0;
  for (std::size_t i = 0; i < still.simulator.state().positions.size(); ++i) {
    const Vec3 expected = still.simulator.state().positions[i];
    EXPECT_LT((dynamic.simulator.state().positions[i] - expected).norm(), 1e-7);
    sag = std::max(sag, (expected - still.simulator.model().mesh.nodes[i]).norm());
  }
  EXPECT_GT(sag, 0.1) << "far beyond the linear";
}

TEST(IteratedStep, TakesPinsThatJumpAndScrambledNodes) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark}) {
    BodyModel model = pinned_bar(0.002);
    Transform jump;
    jump.translate = Vec3(0, 0.4, 0);
    jump.rotate = Vec3(1, 0, 0);
    model.pins[0].track = {{{0, {}, Ease::Constant}, {3, jump, Ease::Constant}}};
    Bench bench(model, iterated_params(integrator));
    SimulationState state = bench.simulator.state();
    const std::vector<Vec3> noise = random_vectors(state.positions.size(), 0.3, 5);
    for (std::size_t i = 0; i < noise.size(); ++i) state.positions[i] += noise[i];
    bench.simulator.set_state(state);
    const double energy = bench.simulator.measure().elastic_energy;
    for (int k = 1; k <= 8; ++k) {
      const StepReport report = bench.simulator.step(k, 1.0 / 24);
      ASSERT_TRUE(report.ok()) << k << ": " << report.culprit;
      if (k == 1) {
        EXPECT_LT(bench.simulator.measure().elastic_energy, energy);
      }
    }
    const auto node = static_cast<std::size_t>(model.pins[0].points[0]);
    EXPECT_EQ(bench.simulator.state().positions[node], jump.apply(model.mesh.nodes[node]));
  }
}

/// A free body is released from a scramble, and every step is solved.
void expect_solved_from(const testing::Scramble& scramble, bool damped, int seed, int steps) {
  SolverParams params;
  params.linearize = Linearize::Iterated;
  BodyModel model = testing::scramble_model(2);
  if (!damped)
    for (ElementMaterial& material : model.materials) material.damping_mass = material.damping_stiffness = 0;
  Bench bench(model, params);
  SimulationState state = bench.simulator.state();
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  state.positions = scramble.positions(model.mesh.nodes, random);
  bench.simulator.set_state(state);
  for (int k = 1; k <= steps; ++k) {
    const StepReport report = bench.simulator.step(k, 1.0 / 24);
    ASSERT_TRUE(report.ok()) << scramble.name << ", seed " << seed << ", step " << k << ": " << report.culprit;
  }
}

TEST(IteratedStep, GoesOnWhereTheExactTangentHasNoUsefulDirection) {
  // Conjugate gradients on its indefinite matrix grew to 1e150 and took that for the limit of round-off.
  expect_solved_from(testing::scrambles()[0], true, 5, 6);
}

TEST(IteratedStep, EndsAtRestWhereTheEnergyIsAllRoundOff) {
  // What rounding the positions does to the energy is far more than rounding its terms.
  for (int seed = 1; seed <= 5; ++seed) expect_solved_from(testing::scrambles()[4], false, seed, 16);
}

TEST(IteratedStep, FindsTheSameBitsOnOneAndFourThreads) {
  Bench one(pinned_bar(0.002), iterated_params(), 1), four(pinned_bar(0.002), iterated_params(), 4);
  for (int k = 1; k <= 3; ++k) {
    ASSERT_TRUE(one.simulator.step(k, 1.0 / 24).ok());
    ASSERT_TRUE(four.simulator.step(k, 1.0 / 24).ok());
  }
  EXPECT_EQ(one.simulator.state().positions, four.simulator.state().positions);
}

TEST(IteratedStep, ServesRotationsWithoutAnEnergyByTheResidual) {
  SolverParams params = iterated_params();
  params.rotation = RotationMethod::Energy;
  params.force_tolerance = 1e-6;
  Bench bench(pinned_bar(), params);
  for (int k = 1; k <= 3; ++k) ASSERT_TRUE(bench.simulator.step(k, 1.0 / 24).ok());
}

SolverParams iterated_without_recovery(Integrator integrator) {
  SolverParams params;
  params.integrator = integrator;
  params.linearize = Linearize::Iterated;
  params.recovery = false;
  return params;
}

/// The energy of a stiff block is a small difference of great numbers, whose rounding hides what a step gains.
TEST(IteratedStep, IsSolvedAtAStiffnessContrastOfAHundredMillion) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    SolverParams params = iterated_without_recovery(integrator);
    params.recovery = true;
    Bench bench(testing::bar_of_blocks(1e8), params);
    for (int k = 1; k <= 8; ++k) {
      const StepReport report = bench.simulator.step(k, 1.0 / 24);
      ASSERT_TRUE(report.ok()) << "step " << k << ": " << report.culprit;
      EXPECT_LE(report.solve.residual, 3 * params.force_tolerance) << "the tolerance, or near it what rounding leaves";
    }
    EXPECT_LT(bench.simulator.state().positions.back().y(), 0.17) << "it sinks";
  }
}

/// Blocks that are all but rigid turn with the bar: how stiff they are does not show, and in large steps no energy is
/// gained beyond what the motion began with.
TEST(IteratedStep, MovesAlikeAtEveryGreatContrast) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark}) {
    std::vector<Vec3> first;
    for (const double contrast : {1e6, 1e9}) {
      Bench bench(testing::bar_of_blocks(contrast), iterated_without_recovery(integrator));
      const auto energy = [&] {
        const StateMeasures measures = bench.simulator.measure();
        return measures.kinetic_energy + measures.elastic_energy + measures.potential_energy;
      };
      const double start = energy();
      for (int k = 1; k <= 24; ++k) {
        ASSERT_TRUE(bench.simulator.step(k, 1.0 / 24).ok()) << contrast << ", step " << k;
        EXPECT_LT(energy(), start) << contrast << ", step " << k;
      }
      const std::vector<Vec3>& positions = bench.simulator.state().positions;
      if (first.empty()) first = positions;
      for (std::size_t i = 0; i < first.size(); ++i) EXPECT_LT((positions[i] - first[i]).norm(), 2e-3);
    }
    EXPECT_LT(first.back().y(), -0.5) << "it sinks far";
  }
}

/// A free, nearly rigid bar that turns by a quarter of a radian in a step.
TEST(IteratedStep, StiffnessDampingLeavesARigidSpinAlone) {
  const Vec3 centre(0.4, 0.1, 0.1), spin(0, 0, 6);
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    std::vector<Vec3> undamped;
    for (const double damping : {0.0, 0.05}) {
      BodyModel model = body_model(thin_iterated_bar(), {2e10, 0.35, 1000, 0, damping});
      model.gravity.setZero();
      Bench bench(model, iterated_without_recovery(integrator));
      SimulationState state = bench.simulator.state();
      for (std::size_t i = 0; i < state.positions.size(); ++i)
        state.velocities[i] = spin.cross(state.positions[i] - centre);
      bench.simulator.set_state(state);
      for (int k = 1; k <= 8; ++k) ASSERT_TRUE(bench.simulator.step(k, 1.0 / 24).ok());
      const std::vector<Vec3>& positions = bench.simulator.state().positions;
      if (undamped.empty()) undamped = positions;
      for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_LT((positions[i] - undamped[i]).norm(), 1e-6);
      EXPECT_GT((positions.back() - model.mesh.nodes.back()).norm(), 0.3) << "it turns";
    }
  }
}

}  // namespace
}  // namespace softreel
