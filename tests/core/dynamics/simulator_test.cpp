#include "core/dynamics/simulator.h"

#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;
using testing::exact_params;

ElementMaterial soft() {
  ElementMaterial material;
  material.youngs_modulus = 1e5;
  material.poisson_ratio = 0.3;
  return material;
}

std::vector<Index> left_end(const TetMesh& mesh) {
  return testing::select_nodes(mesh, [](const Vec3& p) { return p.x() < 1e-9; });
}

std::vector<Index> right_end(const TetMesh& mesh, double length) {
  return testing::select_nodes(mesh, [length](const Vec3& p) { return p.x() > length - 1e-9; });
}

TetMesh small_bar() {
  return testing::kuhn_bar({4, 2, 2}, Vec3(0.4, 0.2, 0.2));
}

TEST(Simulator, FallsAsImplicitEulerSays) {
  Bench bench(body_model(small_bar(), soft()));  // at the default tolerance
  const std::vector<Vec3> rest = bench.simulator.state().positions;
  const double h = 1.0 / 96;
  const int n = 20;
  for (int k = 1; k <= n; ++k) ASSERT_TRUE(bench.simulator.step(k, h).ok());
  const double drop = 9.81 * h * h * n * (n + 1) / 2;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vec3 moved = bench.simulator.state().positions[i] - rest[i];
    EXPECT_NEAR(moved.y(), -drop, 1e-9 * drop);
    EXPECT_NEAR(moved.x(), 0, 1e-9 * drop);
    EXPECT_NEAR(moved.z(), 0, 1e-9 * drop);
  }
}

/// A free body that swings: stretched by 20 % along x, and turning.
SimulationState swinging(const Simulator& simulator) {
  SimulationState state = simulator.state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const Vec3 rest = state.positions[i];
    state.positions[i].x() *= 1.2;
    state.velocities[i] = Vec3(0.3, -0.2, 0.1) + Vec3(0, 0, 2).cross(rest);
  }
  return state;
}

TEST(Simulator, KeepsLinearMomentumAndGainsNoAngularMomentum) {
  BodyModel model = body_model(small_bar(), soft());
  model.gravity.setZero();
  Bench bench(model);
  bench.simulator.set_state(swinging(bench.simulator));
  const StateMeasures start = bench.simulator.measure();
  double angular = start.angular_momentum.norm();
  for (int k = 1; k <= 30; ++k) {
    ASSERT_TRUE(bench.simulator.step(k, 1.0 / 96).ok());
    const StateMeasures now = bench.simulator.measure();
    EXPECT_LT((now.linear_momentum - start.linear_momentum).norm(), 1e-11 * start.linear_momentum.norm());
    angular = now.angular_momentum.norm();
  }
  EXPECT_LT(angular, 1.0001 * start.angular_momentum.norm());
}

TEST(Simulator, HoldsPinsExactly) {
  BodyModel model = body_model(small_bar(), soft());
  Transform end;
  end.translate = Vec3(0.1, 0.05, 0);
  end.rotate = Vec3(0.7, 0, 0);
  Pin pin{"body.bar.pin[0]", left_end(model.mesh), {{{0, {}, Ease::Linear}, {4, end, Ease::Linear}}}, {}};
  model.pins = {pin};
  Bench bench(model);
  for (int frame = 1; frame <= 6; ++frame) {
    const std::vector<Vec3> before = bench.simulator.state().positions;
    ASSERT_TRUE(bench.simulator.step(frame, 1.0 / 24).ok());
    for (const Index point : pin.points) {
      const Tet& tet =
          model.mesh.tets[static_cast<std::size_t>(model.embedding.elements[static_cast<std::size_t>(point)])];
      for (const Index node : tet) {
        const auto i = static_cast<std::size_t>(node);
        const Vec3 target = pin.track.at(frame).apply(model.mesh.nodes[i]);
        EXPECT_EQ(bench.simulator.state().positions[i], target);
        EXPECT_LT((bench.simulator.state().velocities[i] - (target - before[i]) * 24).norm(), 1e-12);
      }
    }
  }
}

TEST(Simulator, SwitchesPinsOnAndOff) {
  BodyModel model = body_model(small_bar(), soft());
  Transform away;
  away.translate = Vec3(0, 0.02, 0);
  Pin pin = testing::make_pin(left_end(model.mesh), away);
  pin.active = {{3, 4}};
  model.pins = {pin};
  Bench bench(model);
  const auto node = static_cast<std::size_t>(pin.points[0]);
  const Vec3 target = away.apply(model.mesh.nodes[node]);
  for (int frame = 1; frame <= 6; ++frame) {
    ASSERT_TRUE(bench.simulator.step(frame, 1.0 / 96).ok());
    const bool held = bench.simulator.state().positions[node] == target;
    EXPECT_EQ(held, frame == 3 || frame == 4) << "frame " << frame;
  }
}

TEST(Simulator, ComesToRestWhereASpringBalancesGravity) {
  BodyModel model = body_model(small_bar(), soft());
  for (ElementMaterial& material : model.materials) {
    material.youngs_modulus = 1e8;
    material.damping_mass = 20;
  }
  std::vector<Index> all(model.mesh.nodes.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
  const double stiffness = 5e4, weight = 1000 * 0.4 * 0.2 * 0.2 * 9.81;
  model.pulls = {testing::make_pull(all, {}, stiffness)};
  // The springs share the stiffness by node, the mass by volume: only the sum of forces balances node by node weights.
  SolverParams params = exact_params();
  Bench bench(model, params);
  for (int k = 1; k <= 200; ++k) ASSERT_TRUE(bench.simulator.step(k, 1.0 / 24).ok());
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < all.size(); ++i)
    mean += (bench.simulator.state().positions[i] - model.mesh.nodes[i]) / static_cast<double>(all.size());
  EXPECT_NEAR(mean.y(), -weight / stiffness, 1e-6 * weight / stiffness);
}

TEST(Simulator, NeverPullsHarderThanMaxForce) {
  BodyModel model = body_model(small_bar(), soft());
  model.gravity.setZero();
  Transform far;
  far.translate = Vec3(5, 0, 0);
  Pull pull = testing::make_pull(right_end(model.mesh, 0.4), far, 1e4);
  pull.max_force = 3;
  model.pulls = {pull};
  Bench bench(model, exact_params());
  const double h = 1.0 / 240;
  double momentum = 0;
  for (int k = 1; k <= 10; ++k) {
    ASSERT_TRUE(bench.simulator.step(k, h).ok());
    const double now = bench.simulator.measure().linear_momentum.x();
    const double force = (now - momentum) / h;
    EXPECT_LE(force, 3 * (1 + 1e-9));
    EXPECT_GT(force, 2.9);
    momentum = now;
  }
}

/// A bar of two materials that a pin holds and a pull drags, in motion.
BodyModel dragged_bar(double stiffest, double half_width = 0.15) {
  BodyModel model = body_model(testing::kuhn_bar({12, 6, 6}, Vec3(1, 0.5, 0.5)), soft());
  for (std::size_t e = 0; e < model.materials.size(); ++e) {
    model.materials[e].damping_stiffness = 0.002;
    model.materials[e].damping_mass = 0.1;
    const Vec3 center = testing::centroid(model.mesh, e);
    if (std::abs(center.x() - 0.5) < 0.2 && std::abs(center.y() - 0.25) < half_width)
      model.materials[e].youngs_modulus = stiffest;
  }
  Transform end;
  end.translate = Vec3(0, 0.2, 0);
  model.pins = {{"body.bar.pin[0]", left_end(model.mesh), {{{0, {}, Ease::Linear}, {4, end, Ease::Linear}}}, {}}};
  Transform away;
  away.translate = Vec3(0.5, 0, 0.3);
  model.pulls = {testing::make_pull(right_end(model.mesh, 1), away, 500)};
  return model;
}

TEST(Simulator, StepsInFloatAsInDoubleToTheTolerance) {
  struct Core {
    double stiffness, half_width;
  };
  constexpr double kThin = 0.05;  // one cell
  for (const auto& [stiffest, half_width] :
       {Core{1e5, 0.15}, {1e8, 0.15}, {1e11, 0.15}, {3e7, kThin}, {1e8, kThin}, {1e9, kThin}})
    for (const double tolerance : {1e-3, 1e-6}) {
      SolverParams params;
      params.tolerance = tolerance;
      Bench bench(dragged_bar(stiffest, half_width), params), exact(dragged_bar(stiffest, half_width), exact_params());
      for (int k = 1; k <= 5; ++k) {
        const SimulationState start = exact.simulator.state();
        bench.simulator.set_state(start);
        ASSERT_TRUE(bench.simulator.step(k, 1.0 / 96).ok());
        ASSERT_TRUE(exact.simulator.step(k, 1.0 / 96).ok());
        double difference = 0, change = 0;
        for (std::size_t i = 0; i < start.velocities.size(); ++i) {
          const Vec3 expected = exact.simulator.state().velocities[i];
          difference += (bench.simulator.state().velocities[i] - expected).squaredNorm();
          change += (start.velocities[i] - expected).squaredNorm();
        }
        // The tolerance bounds the residual; after a multigrid cycle the error is no larger, but for a stiff core.
        EXPECT_LT(std::sqrt(difference), 5 * tolerance * std::sqrt(change))
            << stiffest << " " << half_width << " " << tolerance;
      }
    }
}

/// Cut by a surface: some of its tetrahedra are a tenth as thick as the others, and stiff for their mass.
BodyModel hard_ring(const Threads& threads) {
  const SurfaceMesh surface = test::make_torus(0.3, 0.1, 64, 32, Vec3::Zero());
  StageTimes times;
  BodyModel model = body_model(tetrahedralize(surface, {.edge = 0.03}, "ring", threads, {}, times), soft());
  for (ElementMaterial& material : model.materials) material.youngs_modulus = 1e7;
  model.pins = {testing::make_pin(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() < -0.35; }))};
  return model;
}

TEST(Simulator, ThinTetrahedraAtASurfaceLeaveABodyItsStepsInFloat) {
  const Threads threads(1);
  Bench bench(hard_ring(threads)), exact(hard_ring(threads), exact_params());
  for (int k = 1; k <= 8; ++k) {
    const StepReport step = bench.simulator.step(0.25 * k, 1.0 / 96);
    ASSERT_TRUE(step.ok());
    // Coarse levels are kept by steps in float only.
    EXPECT_EQ(step.kept_hierarchy, k % 4 != 1) << k;
    ASSERT_TRUE(exact.simulator.step(0.25 * k, 1.0 / 96).ok());
  }
  const std::vector<Vec3>&found = bench.simulator.state().positions, &expected = exact.simulator.state().positions;
  const double moved = testing::greatest_distance(expected, hard_ring(threads).mesh.nodes);
  EXPECT_LT(testing::greatest_distance(found, expected), SolverParams().tolerance * moved);
}

TEST(Simulator, StepsWithTheSameBitsOnOneAndFourThreads) {
  BodyModel model = body_model(testing::kuhn_bar({12, 6, 6}, Vec3(1, 0.5, 0.5)), soft());
  model.pins = {testing::make_pin(left_end(model.mesh))};
  Bench one(model, {}, 1), four(model, {}, 4);
  for (int k = 1; k <= 3; ++k) {
    ASSERT_TRUE(one.simulator.step(k, 1.0 / 24).ok());
    ASSERT_TRUE(four.simulator.step(k, 1.0 / 24).ok());
  }
  EXPECT_EQ(one.simulator.state().positions, four.simulator.state().positions);
  EXPECT_EQ(one.simulator.state().velocities, four.simulator.state().velocities);
}

TEST(Simulator, ContinuesAStoredStateWithTheSameBits) {
  BodyModel model = body_model(small_bar(), soft());
  model.pins = {testing::make_pin(left_end(model.mesh))};
  Bench whole(model), resumed(model);
  for (int k = 1; k <= 3; ++k) ASSERT_TRUE(whole.simulator.step(k, 1.0 / 24).ok());
  resumed.simulator.set_state(whole.simulator.state());
  for (int k = 4; k <= 6; ++k) {
    ASSERT_TRUE(whole.simulator.step(k, 1.0 / 24).ok());
    ASSERT_TRUE(resumed.simulator.step(k, 1.0 / 24).ok());
  }
  EXPECT_EQ(whole.simulator.state().positions, resumed.simulator.state().positions);
  EXPECT_EQ(whole.simulator.state().velocities, resumed.simulator.state().velocities);
}

TEST(Simulator, ContinuesAStoredFrameWithTheSameBitsAlthoughStepsKeepCoarseLevels) {
  constexpr int kSubsteps = 4;
  Bench whole(dragged_bar(1e6)), resumed(dragged_bar(1e6), {}, 4);
  const auto simulate_frame = [&](Bench& bench, int frame) {
    for (int s = 1; s <= kSubsteps; ++s)
      ASSERT_TRUE(bench.simulator.step(frame - 1 + static_cast<double>(s) / kSubsteps, 1.0 / 96).ok());
  };
  for (int frame = 1; frame <= 2; ++frame) simulate_frame(whole, frame);
  resumed.simulator.set_state(whole.simulator.state());
  for (int frame = 3; frame <= 4; ++frame) {
    simulate_frame(whole, frame);
    simulate_frame(resumed, frame);
  }
  EXPECT_EQ(whole.simulator.state().positions, resumed.simulator.state().positions);
  EXPECT_EQ(whole.simulator.state().velocities, resumed.simulator.state().velocities);
}

TEST(Simulator, BlamesAnElementForWhatIsNotANumber) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e308}) {
    Bench bench(body_model(small_bar(), soft()));
    SimulationState state = bench.simulator.state();
    state.positions[7].y() = bad;
    bench.simulator.set_state(state);
    const StepReport report = bench.simulator.step(1, 1.0 / 24);
    EXPECT_FALSE(report.ok());
    EXPECT_NE(report.culprit.find("body.bar: element "), std::string::npos) << report.culprit;
    EXPECT_NE(report.culprit.find("not finite"), std::string::npos) << report.culprit;
    EXPECT_EQ(bench.simulator.state().positions[6], state.positions[6]);
  }
}

TEST(Simulator, BlamesThePullForAForceThatIsNotANumber) {
  for (const Linearize linearize : {Linearize::Auto, Linearize::Iterated}) {
    BodyModel model = body_model(small_bar(), soft());
    Transform away;
    away.translate = Vec3(0, 2, 0);
    for (const double stiffness : {1e3, 1e300})
      model.pulls.push_back({fmt::format("body.bar.pull[{}]", model.pulls.size()),
                             {0},
                             {1.0},
                             {{{0, away, Ease::Constant}}},
                             {{{0, stiffness, Ease::Constant}}},
                             0,
                             {}});
    SolverParams params;
    params.linearize = linearize;
    Bench bench(model, params);
    const StepReport report = bench.simulator.step(1, 1.0 / 24);
    EXPECT_FALSE(report.ok());
    EXPECT_EQ(report.culprit.find("body.bar.pull[1]"), 0U) << report.culprit;
    EXPECT_NE(report.culprit.find("1e+300 N/m"), std::string::npos) << report.culprit;
  }
}

TEST(Simulator, RefusesPinsThatContradictEachOther) {
  BodyModel model = body_model(small_bar(), soft());
  Transform moved;
  moved.translate.x() = 0.1;
  model.pins = {testing::make_pin(left_end(model.mesh)), testing::make_pin(left_end(model.mesh), moved)};
  model.pins[1].name = "body.bar.pin[1]";
  try {
    Bench bench(model);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    const std::string message = error.what();
    for (const char* part : {"body.bar.pin[0]", "body.bar.pin[1]", "node", "Accepted", "Select"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST(Simulator, RefusesPinsThatContradictEachOtherBetweenTwoFramesWhereItMeetsThem) {
  // Equal at both keys, apart between them: one goes linearly, the other jumps at the end.
  BodyModel model = body_model(small_bar(), soft());
  Transform moved;
  moved.translate.x() = 0.1;
  Pin linear = testing::make_pin(left_end(model.mesh)), jump = linear;
  linear.track = {{{4, {}, Ease::Linear}, {5, moved, Ease::Linear}}};
  jump.track = {{{4, {}, Ease::Constant}, {5, moved, Ease::Constant}}};
  jump.name = "body.bar.pin[1]";
  model.pins = {linear, jump};
  Bench bench(model);
  EXPECT_TRUE(bench.simulator.step(4, 1.0 / 24).ok());
  const std::vector<Vec3> before = bench.simulator.state().positions;
  for (const bool is_static : {false, true}) {
    try {
      if (is_static)
        bench.simulator.find_equilibrium(4.5);
      else
        bench.simulator.step(4.5, 1.0 / 48);
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      EXPECT_EQ(std::string(error.what()).find("body.bar.pin[0] and body.bar.pin[1]"), 0U) << error.what();
    }
    EXPECT_EQ(bench.simulator.state().positions, before);
  }
}

TEST(Simulator, DampsASwingAtTheRayleighRate) {
  // Mass damping alone on rigid translation: v' = v / (1 + h a) per step, exactly.
  BodyModel model = body_model(small_bar(), soft());
  model.gravity.setZero();
  for (ElementMaterial& material : model.materials) material.damping_mass = 3;
  Bench bench(model);
  SimulationState state = bench.simulator.state();
  for (Vec3& v : state.velocities) v = Vec3(1, 2, -1);
  bench.simulator.set_state(state);
  const double h = 1.0 / 24;
  for (int k = 1; k <= 8; ++k) ASSERT_TRUE(bench.simulator.step(k, h).ok());
  const Vec3 expected = Vec3(1, 2, -1) * std::pow(1 + 3 * h, -8);
  for (const Vec3& v : bench.simulator.state().velocities) EXPECT_LT((v - expected).norm(), 1e-11);
}

}  // namespace
}  // namespace softreel
