/// Bodies that glue joins to one system: they move as one, keep their momentum, and start and resume without a jump.
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/glued_bars.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;
using testing::constant;
using testing::exact_params;
using testing::glued;
using testing::kuhn_bar;
using testing::make_pin;
using testing::moved_model;

constexpr double kStep = 1.0 / 96;

ElementMaterial soft(double youngs_modulus = 1e5) {
  ElementMaterial material;
  material.youngs_modulus = youngs_modulus;
  material.poisson_ratio = 0.3;
  return material;
}

BodyModel pinned_left(BodyModel model) {
  model.pins.push_back(make_pin(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; })));
  return model;
}

/// How far the end of a bar of 0.8 x 0.2 x 0.2 m sinks.
double tip_of(const BodyModel& model) {
  Bench bench(model);
  EXPECT_TRUE(bench.simulator.find_equilibrium(1).ok());
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < model.mesh.nodes.size(); ++i)
    if (model.mesh.nodes[i].x() > 0.8 - 1e-9) {
      sum += model.mesh.nodes[i].y() - bench.simulator.state().positions[i].y();
      ++count;
    }
  return sum / count;
}

/// The bar in one piece, or in halves of `across` and `other` cells across.
BodyModel whole_bar(int across) {
  return pinned_left(body_model(kuhn_bar({4 * across, across, across}, Vec3(0.8, 0.2, 0.2)), soft()));
}

BodyModel halves(int across, int other, double stiffer = 1) {
  const Vec3 size(0.4, 0.2, 0.2);
  return glued(pinned_left(moved_model(kuhn_bar({2 * across, across, across}, size), soft(), Vec3::Zero(), "left")),
               moved_model(kuhn_bar({2 * other, other, other}, size), soft(stiffer * 1e5), Vec3(0.4, 0, 0), "right"),
               1e-3);
}

TEST(GluedBodies, TwoBarsEndToEndBendLikeOne) {
  const double coarse = std::abs(tip_of(halves(2, 2)) / tip_of(whole_bar(2)) - 1);
  const double fine = std::abs(tip_of(halves(4, 4)) / tip_of(whole_bar(4)) - 1);
  EXPECT_LT(coarse, 0.01);
  EXPECT_LT(fine, 0.7 * coarse);
}

TEST(GluedBodies, BarsOfDifferentMeshesBendLikeOneToo) {
  const double between = 0.5 * (tip_of(whole_bar(2)) + tip_of(whole_bar(4)));
  const double range = 0.5 * std::abs(tip_of(whole_bar(4)) - tip_of(whole_bar(2)));
  EXPECT_NEAR(tip_of(halves(2, 4)), between, range + 0.03 * between);
  EXPECT_NEAR(tip_of(halves(4, 2)), between, range + 0.03 * between);
}

TEST(GluedBodies, AStiffHalfOnASoftOneSinksAsInOnePiece) {
  for (const double stiffer : {1e4, 1e-2}) {
    BodyModel one = whole_bar(3);
    for (std::size_t e = 0; e < one.materials.size(); ++e)
      if (testing::centroid(one.mesh, e).x() > 0.4) one.materials[e].youngs_modulus *= stiffer;
    const double tip = tip_of(one);
    EXPECT_NEAR(tip_of(halves(3, 3, stiffer)), tip, 0.03 * tip) << stiffer;
  }
}

/// Two free cubes with a gap that turn and swing.
BodyModel free_cubes(double stiffer = 1) {
  BodyModel model = glued(
      moved_model(kuhn_bar({2, 2, 2}, Vec3::Constant(0.2)), soft(), Vec3::Zero(), "left"),
      moved_model(kuhn_bar({3, 3, 3}, Vec3::Constant(0.2)), soft(stiffer * 1e5), Vec3(0.22, 0.01, 0), "right"), 0.03);
  model.gravity.setZero();
  return model;
}

SimulationState swinging_together(const Simulator& simulator) {
  SimulationState state = simulator.state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const Vec3 rest = state.positions[i];
    state.positions[i].x() *= 1.1;
    state.velocities[i] = Vec3(0.3, -0.2, 0.1) + Vec3(0, 0, 2).cross(rest) + Vec3(0, rest.x() * rest.x(), 0);
  }
  return state;
}

TEST(GluedBodies, FreeOnesKeepTheirLinearMomentumToRoundOff) {
  for (const double stiffer : {1.0, 1e4}) {
    Bench bench(free_cubes(stiffer));
    bench.simulator.set_state(swinging_together(bench.simulator));
    const StateMeasures start = bench.simulator.measure();
    for (int k = 1; k <= 20; ++k) {
      ASSERT_TRUE(bench.simulator.step(k, kStep).ok());
      const Vec3 change = bench.simulator.measure().linear_momentum - start.linear_momentum;
      EXPECT_LT(change.norm(), 1e-11 * start.linear_momentum.norm());
    }
  }
}

/// Loss of angular momentum in a fifth of a second.
double angular_loss(const BodyModel& model, double step) {
  SolverParams params = exact_params();
  params.integrator = Integrator::Newmark;
  Bench bench(model, params);
  bench.simulator.set_state(swinging_together(bench.simulator));
  const Vec3 start = bench.simulator.measure().angular_momentum;
  for (int k = 1; k <= static_cast<int>(std::lround(0.2 / step)); ++k) EXPECT_TRUE(bench.simulator.step(k, step).ok());
  return (bench.simulator.measure().angular_momentum - start).norm() / start.norm();
}

TEST(GluedBodies, FreeOnesKeepTheirAngularMomentumAsTheIntegratorDoes) {
  const double coarse = angular_loss(free_cubes(), kStep), fine = angular_loss(free_cubes(), kStep / 4);
  EXPECT_LT(coarse, 0.02);
  EXPECT_LT(fine, 0.15 * coarse) << "of second order";
}

/// Largest distance between the positions of two states.
double distance(const SimulationState& a, const SimulationState& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i)
    largest = std::max(largest, (a.positions[i] - b.positions[i]).norm());
  return largest;
}

TEST(GluedBodies, GlueThatStartsWhileBothMoveAlikeChangesNothing) {
  BodyModel with = free_cubes();
  with.gravity = Vec3(0, -9.81, 0);
  with.glues[0].active = {{10, 20}};
  BodyModel without = with;
  without.glues.clear();
  Bench a(with), b(without);
  for (int k = 1; k <= 20; ++k) {
    ASSERT_TRUE(a.simulator.step(k, kStep).ok());
    ASSERT_TRUE(b.simulator.step(k, kStep).ok());
    EXPECT_EQ(a.simulator.state().bonds.empty(), k < 10);
    EXPECT_LT(distance(a.simulator.state(), b.simulator.state()), 1e-9);
  }
}

TEST(GluedBodies, GlueThatStartsInTheMiddleHoldsThemWhereTheyAreAndLetsGoAgain) {
  BodyModel model = free_cubes();
  const auto nodes = static_cast<std::size_t>(model.parts[1].first_node);
  model.glues[0].active = {{5, 60}};
  model.glues[0].distance = 0.1;
  Bench bench(model);
  SimulationState start = bench.simulator.state();
  for (std::size_t i = nodes; i < start.velocities.size(); ++i) start.velocities[i] = Vec3(0.5, 0, 0);  // moves away
  bench.simulator.set_state(start);
  const auto gap = [&] {
    const std::vector<Vec3>& x = bench.simulator.state().positions;
    Vec3 left = Vec3::Zero(), right = Vec3::Zero();
    for (std::size_t i = 0; i < x.size(); ++i)
      (i < nodes ? left : right) += x[i] / static_cast<double>(i < nodes ? nodes : x.size() - nodes);
    return right.x() - left.x();
  };
  double before = gap();
  for (int k = 1; k <= 4; ++k) ASSERT_TRUE(bench.simulator.step(k, kStep).ok());
  EXPECT_NEAR(gap() - before, 4 * kStep * 0.5, 1e-6) << "nothing holds them yet";
  before = gap();
  ASSERT_TRUE(bench.simulator.step(5, kStep).ok());
  EXPECT_LT(gap() - before, kStep * 0.5 + 1e-6) << "drawn back, not thrown";
  EXPECT_GT(gap() - before, 0);
  for (int k = 6; k <= 60; ++k) ASSERT_TRUE(bench.simulator.step(k, kStep).ok());
  EXPECT_NEAR(gap(), before, 0.02) << "free, they would be a quarter of a metre apart";
  ASSERT_TRUE(bench.simulator.step(61, kStep).ok());
  EXPECT_TRUE(bench.simulator.state().bonds.empty());
}

TEST(GluedBodies, ARangeThatFollowsWithoutAGapBindsAnew) {
  const auto moves_apart = [](std::vector<FrameRange> active) {
    BodyModel model = free_cubes();
    model.glues[0].active = std::move(active);
    model.glues[0].distance = 0.1;
    model.glues[0].stiffness = constant(1.0);  // so weak that they drift apart while it holds
    Bench bench(model);
    SimulationState start = bench.simulator.state();
    for (std::size_t i = static_cast<std::size_t>(model.parts[1].first_node); i < start.velocities.size(); ++i)
      start.velocities[i] = Vec3(0.2, 0, 0);
    bench.simulator.set_state(start);
    for (int k = 1; k <= 11; ++k) EXPECT_TRUE(bench.simulator.step(k, kStep).ok());
    return bench.simulator.state();
  };
  const SimulationState one = moves_apart({{1, 20}}), two = moves_apart({{1, 10}, {11, 20}});
  ASSERT_FALSE(two.bonds.empty());
  for (const GlueBond& bond : one.bonds) EXPECT_EQ(bond.since, 1);
  for (const GlueBond& bond : two.bonds) EXPECT_EQ(bond.since, 11);
  EXPECT_GT(distance(one, two), 1e-9) << "the spring of the second range has no stretch yet";
}

TEST(GluedBodies, WithoutStiffnessIsWithoutGlue) {
  BodyModel with = free_cubes();
  with.glues[0].stiffness = constant(0.0);
  BodyModel without = free_cubes();
  without.glues.clear();
  Bench a(with), b(without);
  a.simulator.set_state(swinging_together(a.simulator));
  b.simulator.set_state(swinging_together(b.simulator));
  for (int k = 1; k <= 5; ++k) {
    ASSERT_TRUE(a.simulator.step(k, kStep).ok());
    ASSERT_TRUE(b.simulator.step(k, kStep).ok());
  }
  EXPECT_EQ(distance(a.simulator.state(), b.simulator.state()), 0);
}

TEST(GluedBodies, ResumeFromAnyStateWithTheSameBits) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    SolverParams params;
    params.integrator = integrator;
    BodyModel model = free_cubes();
    model.glues[0].active = {{3, 6}, {7, 8}, {9.5, 20}};
    model.glues[0].close_frames = 4;
    model.glues[0].distance = 0.1;
    Bench through(model, params);
    through.simulator.set_state(swinging_together(through.simulator));
    std::vector<SimulationState> states{through.simulator.state()};
    for (int k = 1; k <= 10; ++k) {
      ASSERT_TRUE(through.simulator.step(k, kStep).ok());
      states.push_back(through.simulator.state());
    }
    for (const std::size_t from : {2U, 4U, 6U, 9U}) {
      Bench resumed(model, params);
      resumed.simulator.set_state(states[from]);
      for (std::size_t k = from + 1; k <= 10; ++k)
        ASSERT_TRUE(resumed.simulator.step(static_cast<double>(k), kStep).ok());
      EXPECT_EQ(distance(resumed.simulator.state(), states[10]), 0) << "from " << from;
      EXPECT_EQ(resumed.simulator.state().bonds, states[10].bonds);
    }
  }
}

TEST(GluedBodies, AFreeBodyHangsOnTheOneThatPinsHold) {
  BodyModel loose = halves(2, 2);
  loose.glues.clear();
  Bench falls(loose);
  try {
    falls.simulator.find_equilibrium(1);
    ADD_FAILURE() << "half of the bar falls for ever";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("left + right"), std::string::npos) << error.what();
  }
  BodyModel held = halves(2, 2);
  held.glues[0].max_force = 3;  // N; its weight is 157 N
  Bench limited(held);
  EXPECT_THROW(limited.simulator.find_equilibrium(1), Error) << "so little cannot carry it";
}

TEST(GluedBodies, ASoftBodyOnAStiffOneTakesNoMoreIterations) {
  const Vec3 size(0.4, 0.2, 0.2);
  int before = 0;
  for (const double stiffer : {1.0, 1e3, 1e6}) {
    const BodyModel model =
        glued(pinned_left(moved_model(kuhn_bar({4, 2, 2}, size), soft(stiffer * 1e5), Vec3::Zero(), "left")),
              moved_model(kuhn_bar({4, 2, 2}, size), soft(), Vec3(0.4, 0, 0), "right"), 1e-3);
    Bench bench(model);
    const StepReport report = bench.simulator.find_equilibrium(1);
    EXPECT_TRUE(report.ok()) << stiffer;
    EXPECT_TRUE(before == 0 || report.nonlinear_iterations <= 2 * before) << stiffer << " " << before;
    before = report.nonlinear_iterations;
  }
}

TEST(GluedBodies, GlueLetsGoAtOnceOfWhatIsTooHeavy) {
  BodyModel model = halves(2, 2);
  model.glues[0].max_force = 30;  // N
  const double weight = 0.4 * 0.2 * 0.2 * 1000 * 9.81;
  Bench bench(model);
  const int steps = 12;
  for (int k = 1; k <= steps; ++k) ASSERT_TRUE(bench.simulator.step(k, kStep).ok());
  const std::vector<Vec3>& velocities = bench.simulator.state().velocities;
  const std::size_t half = velocities.size() / 2;  // the right one, whose nodes come last
  double speed = 0;
  for (std::size_t i = half; i < velocities.size(); ++i) speed -= velocities[i].y() / static_cast<double>(half);
  const double fall = 9.81 * steps * kStep;
  EXPECT_GT(speed, (1 - 30 / weight) * fall) << "as if 30 N had held it all the time";
  EXPECT_LT(speed, fall);
}

TEST(GluedBodies, GlueTooStiffToBeSolvedIsNamed) {
  BodyModel model = halves(8, 7);
  model.glues[0].stiffness = constant(1e15);
  SolverParams params;
  params.max_iterations = 3;
  params.tolerance = 1e-9;
  Bench bench(model, params);
  const StepReport report = bench.simulator.step(1, kStep);
  ASSERT_FALSE(report.ok());
  EXPECT_NE(report.culprit.find("glue[0]: its stiffness of 1e+15 N/m"), std::string::npos) << report.culprit;
  EXPECT_TRUE(bench.simulator.state().bonds.empty()) << "the state is left as it was";
}

/// Halves of which the right one is hardly there at the edges of its glued face, as lattice cells at a surface are.
BodyModel halves_with_empty_edges() {
  const Vec3 size(0.4, 0.2, 0.2);
  BodyModel right = moved_model(kuhn_bar({16, 8, 8}, size), soft(), Vec3(0.4, 0, 0), "right");
  right.mesh.fill.assign(right.mesh.tets.size(), 1.0);
  for (std::size_t e = 0; e < right.mesh.tets.size(); ++e)
    for (const Index node : right.mesh.tets[e]) {
      const Vec3& x = right.mesh.nodes[static_cast<std::size_t>(node)];
      if (x.x() < 0.4 + 1e-9 && x.y() < 1e-9) right.mesh.fill[e] = 1e-5;
    }
  return glued(pinned_left(moved_model(kuhn_bar({14, 7, 7}, size), soft(), Vec3::Zero(), "left")), right, 1e-3);
}

TEST(GluedBodies, NodesOfHardlyAnyMassDoNotSendStepsToDouble) {
  // Only steps in float keep coarse levels, within a frame.
  SolverParams exact;
  exact.tolerance = 1e-9;
  const BodyModel model = halves_with_empty_edges();
  Bench in_float(model), in_double(model, exact);
  int kept = 0;
  double moved = 0;
  for (int k = 1; k <= 24; ++k) {
    const StepReport report = in_float.simulator.step(k / 4.0, kStep);
    ASSERT_TRUE(report.ok());
    kept += report.kept_hierarchy ? 1 : 0;
    const StepReport reference = in_double.simulator.step(k / 4.0, kStep);
    ASSERT_TRUE(reference.ok());
    ASSERT_FALSE(reference.kept_hierarchy);
    const SimulationState &a = in_float.simulator.state(), &b = in_double.simulator.state();
    for (std::size_t i = 0; i < a.positions.size(); ++i)
      moved = std::max(moved, (b.positions[i] - model.mesh.nodes[i]).norm());
    ASSERT_LT(distance(a, b), 1e-3 * moved) << k;
  }
  EXPECT_GT(kept, 12);
  EXPECT_GT(moved, 0.02);
}

TEST(GluedBodies, BodiesOfVeryDifferentMeshesAreSolvedInAsFewIterations) {
  const auto iterations = [](int across, int other) {
    Bench bench(halves(across, other));
    EXPECT_TRUE(bench.simulator.step(1, kStep).ok());
    return bench.simulator.step(2, kStep).solve.iterations;
  };
  EXPECT_LE(iterations(8, 2), 3 * iterations(8, 8));
  EXPECT_LE(iterations(2, 8), 3 * iterations(8, 8));
}

}  // namespace
}  // namespace softreel
