#include "core/dynamics/recovery.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "core/elasticity/element_rotation.h"
#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/fan.h"
#include "tests/support/scrambled.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;

ElementMaterial gel() {
  return {1e5, 0.35, 1000, 2, 0.01};
}

Index count_sharing(const ElementTroubles& troubles) {
  return static_cast<Index>(
      std::count_if(troubles.begin(), troubles.end(), [](const ElementTrouble& t) { return t.sharing > 0; }));
}

class EveryScramble : public ::testing::TestWithParam<testing::Scramble> {};
INSTANTIATE_TEST_SUITE_P(Starts, EveryScramble, ::testing::ValuesIn(testing::scrambles()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(EveryScramble, ComesBackToRestEveryTime) {
  for (const RotationMethod rotation : {RotationMethod::Consistent, RotationMethod::Energy})
    for (int seed = 1; seed <= 10; ++seed) {
      const testing::Release release =
          testing::release(testing::scramble_model(2), GetParam(), rotation, true, seed, 60);
      EXPECT_TRUE(release.came_back) << "seed " << seed;
    }
}

TEST(Recovery, BringsBodiesBackInWhichStiffElementsAreScattered) {
  for (const double contrast : {30.0, 100.0, 1e4})
    for (int seed = 1; seed <= 4; ++seed) {
      BodyModel model = testing::scramble_model(2);
      std::mt19937_64 random(100 + static_cast<unsigned>(seed));
      std::bernoulli_distribution is_stiff(0.2);
      for (ElementMaterial& material : model.materials)
        if (is_stiff(random)) material.youngs_modulus *= contrast;
      const testing::Release release =
          testing::release(model, testing::scrambles()[0], RotationMethod::Consistent, true, seed, 100);
      EXPECT_TRUE(release.came_back) << "contrast " << contrast << ", seed " << seed;
    }
}

TEST(Recovery, BringsScrambledBodiesBackInFarFewerSteps) {
  int with = 0, without = 0;
  for (int seed = 1; seed <= 5; ++seed)
    for (const bool recovery : {false, true})
      (recovery ? with : without) += testing::release(testing::scramble_model(3), testing::scrambles()[0],
                                                      RotationMethod::Consistent, recovery, seed, 200)
                                         .steps;
  EXPECT_LT(2 * with, without);
}

/// A free ring of ten tetrahedra wound twice about its edge, at rest.
SimulationState wound_twice(const Simulator& simulator) {
  SimulationState state = simulator.state();
  state.positions = testing::wound_fan(simulator.model().mesh, 2);
  // Near enough to flat that one look at the rings is due; without it a set state is taken as it is.
  state.troubles.assign(simulator.model().mesh.tets.size(), {0, 0, 0, kStepsToWatch});
  return state;
}

TEST(Recovery, UnwindsARingThatElementRotationsLeaveWoundTwice) {
  for (const bool recovery : {false, true}) {
    BodyModel model = body_model(testing::fan_mesh(10), gel());
    model.gravity.setZero();
    SolverParams params;
    params.recovery = recovery;
    Bench bench(model, params);
    bench.simulator.set_state(wound_twice(bench.simulator));
    for (int k = 1; k <= 120; ++k) ASSERT_TRUE(bench.simulator.step(k, 1.0 / 24).ok());
    const double distance = testing::distance_from_rigid(model.mesh.nodes, bench.simulator.state().positions);
    if (recovery)
      EXPECT_LT(distance, 1e-3);
    else
      EXPECT_GT(distance, 0.05) << "the check can fail";
  }
}

TEST(Recovery, KeepsNothingOfAHealthyBody) {
  BodyModel model = body_model(testing::kuhn_bar({4, 2, 2}, Vec3(0.4, 0.2, 0.2)), gel());
  Bench bench(model);
  for (int k = 1; k <= 5; ++k) {
    const StepReport report = bench.simulator.step(k, 1.0 / 24);
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report.recovery.elements, 0);
    EXPECT_TRUE(bench.simulator.state().troubles.empty());
  }
}

TEST(Recovery, ForgetsABodyThatIsWellAgain) {
  BodyModel model = testing::scramble_model(2);
  Bench bench(model);
  std::mt19937_64 random(1);
  SimulationState state = bench.simulator.state();
  state.positions = testing::scrambles()[0].positions(model.mesh.nodes, random);
  bench.simulator.set_state(state);
  bool shared = false;
  for (int k = 1; k <= 60; ++k) {
    ASSERT_TRUE(bench.simulator.step(k, 1.0 / 24).ok());
    shared = shared || count_sharing(bench.simulator.state().troubles) > 0;
  }
  EXPECT_TRUE(shared);
  EXPECT_TRUE(bench.simulator.state().troubles.empty());
}

TEST(Recovery, ContinuesAStoredStateWithTheSameBitsOnAnyNumberOfThreads) {
  BodyModel model = testing::scramble_model(4);
  Bench whole(model), resumed(model, {}, 4);
  std::mt19937_64 random(3);
  SimulationState state = whole.simulator.state();
  state.positions = testing::scrambles()[0].positions(model.mesh.nodes, random);
  whole.simulator.set_state(state);
  for (int k = 1; k <= 8; ++k) ASSERT_TRUE(whole.simulator.step(k, 1.0 / 24).ok());
  ASSERT_GT(count_sharing(whole.simulator.state().troubles), 0) << "in the middle of it";
  resumed.simulator.set_state(whole.simulator.state());
  for (int k = 9; k <= 16; ++k) {
    ASSERT_TRUE(whole.simulator.step(k, 1.0 / 24).ok());
    ASSERT_TRUE(resumed.simulator.step(k, 1.0 / 24).ok());
  }
  EXPECT_EQ(whole.simulator.state().positions, resumed.simulator.state().positions);
  EXPECT_EQ(whole.simulator.state().velocities, resumed.simulator.state().velocities);
  EXPECT_EQ(whole.simulator.state().troubles, resumed.simulator.state().troubles);
}

TEST(Recovery, SaysInTheLogWhereItBeginsAndEnds) {
  BodyModel model = testing::scramble_model(2);
  std::vector<std::string> lines;
  Log log{[&](const std::string& line) { lines.push_back(line); }, {}};
  const Threads threads(1);
  StageTimes times;
  Simulator simulator(model, {}, threads, log, times);
  SimulationState state = simulator.state();
  std::mt19937_64 random(1);
  state.positions = testing::scrambles()[0].positions(model.mesh.nodes, random);
  simulator.set_state(state);
  for (int k = 1; k <= 60; ++k) ASSERT_TRUE(simulator.step(k, 1.0 / 24).ok());
  ASSERT_GE(lines.size(), 2U);
  for (const char* part : {"body.box", "frame 6", "144 of 144 elements", "1 patch"})
    EXPECT_NE(lines[0].find(part), std::string::npos) << lines[0];
  EXPECT_NE(lines.back().find("recovery ends"), std::string::npos) << lines.back();
}

/// A bar with one node inside pushed through a face, which inverts some of its elements, looked at again and again.
struct Watched {
  explicit Watched(bool held_by_pin = false) : held_pieces{static_cast<std::uint8_t>(held_by_pin ? 1 : 0)} {
    mesh = testing::kuhn_bar({8, 3, 3}, Vec3(0.8, 0.3, 0.3));
    body = make_elastic_body(mesh, std::vector<ElementMaterial>(mesh.tets.size(), gel()), Dilatation::Capped);
    pieces = find_pieces(mesh.tets, mesh.nodes.size());
    positions = mesh.nodes;
    held_nodes.assign(mesh.nodes.size(), 0);
    for (std::size_t i = 0; i < positions.size(); ++i)
      if ((positions[i] - Vec3(0.1, 0.1, 0.1)).norm() < 1e-9) positions[i].x() += 0.15;
  }

  RecoveryReport look(int times, double seconds = kPaceSeconds) {
    RecoveryReport report;
    for (int k = 0; k < times; ++k) {
      std::vector<Quaternion> rotations(body.tets.size(), Quaternion::Identity());
      const Threads threads(1);
      const std::int64_t flat =
          find_rotations_and_flat(body, RotationMethod::Consistent, positions, rotations, threads);
      report = {};
      count_troubles(body, positions, flat, {held_nodes, held_pieces, pieces}, seconds, troubles, report);
      given_up += report.given_up;
    }
    return report;
  }
  Index sharing() const { return count_sharing(troubles); }

  TetMesh mesh;
  ElasticBody body;
  Pieces pieces;
  std::vector<Vec3> positions;
  std::vector<std::uint8_t> held_nodes, held_pieces;
  ElementTroubles troubles;
  Index given_up = 0;
};

TEST(CountTroubles, TakesANeighbourhoodThatGrowsARingEveryTwelveSteps) {
  Watched bar;
  bar.look(kStepsToTrouble - 1);
  EXPECT_EQ(bar.sharing(), 0);
  bar.look(1);
  const Index one_ring = bar.sharing();
  EXPECT_GT(one_ring, 0);
  EXPECT_LT(one_ring, 0.6 * static_cast<double>(bar.mesh.tets.size()));
  bar.look(kStepsPerRing - 1);
  EXPECT_EQ(bar.sharing(), one_ring);
  bar.look(1);
  EXPECT_GT(bar.sharing(), one_ring);
  bar.look(8 * kStepsPerRing);
  EXPECT_EQ(bar.sharing(), static_cast<Index>(bar.mesh.tets.size()));
}

TEST(CountTroubles, LeavesOutWhatIsMuchStifferUntilTheTroubleLasts) {
  Watched bar;
  const auto is_stiff = [&](std::size_t e) { return testing::centroid(bar.mesh, e).x() > 0.2; };
  for (std::size_t e = 0; e < bar.mesh.tets.size(); ++e)
    if (is_stiff(e)) bar.body.laws[e].mu *= 1000;
  const auto stiff_that_share = [&] {
    Index count = 0;
    for (std::size_t e = 0; e < bar.troubles.size(); ++e) count += is_stiff(e) && bar.troubles[e].sharing > 0;
    return count;
  };
  bar.look(kStepsToTrouble);
  EXPECT_GT(bar.sharing(), 0);
  EXPECT_EQ(stiff_that_share(), 0);
  bar.look(kStepsPerRing);
  EXPECT_GT(stiff_that_share(), 0);
}

TEST(CountTroubles, CountsShortStepsByTheirTimeAndLongOnesAsOne) {
  Watched by_short, by_long;
  by_short.look(4 * kStepsToTrouble - 1, kPaceSeconds / 4);
  EXPECT_EQ(by_short.sharing(), 0);
  by_short.look(1, kPaceSeconds / 4);
  EXPECT_GT(by_short.sharing(), 0);
  by_long.look(kStepsToTrouble - 1, 1);
  EXPECT_EQ(by_long.sharing(), 0);
  by_long.look(1, 1);
  EXPECT_EQ(by_long.sharing(), by_short.sharing());
}

TEST(CountTroubles, EndsTheSharingEightStepsAfterTheTroubleAndThenForgetsIt) {
  Watched bar;
  bar.look(kStepsToTrouble);
  bar.positions = bar.mesh.nodes;
  bar.look(kStepsToShare - 1);
  EXPECT_GT(bar.sharing(), 0);
  bar.look(1);
  EXPECT_EQ(bar.sharing(), 0);
  EXPECT_FALSE(bar.troubles.empty()) << "what it took is remembered for as long";
  bar.look(kStepsToShare);
  EXPECT_TRUE(bar.troubles.empty());
}

TEST(CountTroubles, GivesUpOnceWhereAPinMayHoldTheInversionAndNeverOnAFreeBody) {
  Watched held(true), free_bar(false);
  held.look(2 * kStepsToGiveUp);
  free_bar.look(2 * kStepsToGiveUp);
  EXPECT_EQ(held.sharing(), 0);
  EXPECT_GT(held.given_up, 0);
  EXPECT_LT(held.given_up, 24) << "each inverted element once";
  EXPECT_EQ(free_bar.sharing(), static_cast<Index>(free_bar.mesh.tets.size()));
  EXPECT_EQ(free_bar.given_up, 0);
  held.positions = held.mesh.nodes;
  held.look(2 * kStepsToGiveUp);
  EXPECT_TRUE(held.troubles.empty()) << "another chance once it is well again";
}

TEST(CountTroubles, LeavesElementsAloneWhoseNodesAreAllHeld) {
  Watched bar(true);
  for (std::size_t i = 0; i < bar.held_nodes.size(); ++i) bar.held_nodes[i] = 1;
  bar.look(5 * kStepsToTrouble);
  EXPECT_EQ(bar.sharing(), 0);
}

TEST(ShareRotations, GivesEachPatchTheRotationOfItsSumAndOthersTheirOwn) {
  Watched bar;
  const std::size_t n = bar.mesh.tets.size();
  bar.troubles.resize(n);
  const auto patch_of = [&](std::size_t e) {
    const double x = testing::centroid(bar.mesh, e).x();
    return x < 0.2 ? 1 : x > 0.5 ? 2 : 0;
  };
  Mat3 sums[3] = {Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
  for (Vec3& p : bar.positions) p = Vec3(p.x() + 0.3 * p.y(), p.y() - p.x() * p.x(), p.z() + p.x() * p.y());
  for (std::size_t e = 0; e < n; ++e) {
    if (patch_of(e) > 0) bar.troubles[e].sharing = 1;
    sums[patch_of(e)] += bar.body.shapes[e].volume *
                         deformation_gradient(bar.body.shapes[e].gradients, nodes_of(bar.mesh.tets[e], bar.positions));
  }
  std::vector<Quaternion> own(n, Quaternion::Identity());
  find_rotations(bar.body, RotationMethod::Consistent, bar.positions, own, Threads(1));
  std::vector<Quaternion> shared = own;
  RecoveryReport report;
  share_rotations(bar.body, bar.positions, kPaceSeconds, bar.troubles, own, shared, report);
  EXPECT_EQ(report.patches, 2);
  EXPECT_EQ(report.elements, count_sharing(bar.troubles));
  for (std::size_t e = 0; e < n; ++e) {
    const int patch = patch_of(e);
    const Quaternion expected = patch == 0 ? own[e] : find_rotation(sums[patch], Quaternion::Identity());
    EXPECT_LT(shared[e].angularDistance(expected), patch == 0 ? 1e-300 : 1e-7) << e;
  }
}

TEST(ShareRotations, LeavesAPatchAloneThatIsDrawnOut) {
  Watched bar;
  const std::size_t n = bar.mesh.tets.size();
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const double stretch : {0.98 * kDrawnOut, 1.02 * kDrawnOut}) {
    for (std::size_t i = 0; i < bar.positions.size(); ++i) {
      const Vec3& rest = bar.mesh.nodes[i];
      bar.positions[i] = turn * Vec3(stretch * rest.x(), 0.4 * rest.y(), 0.4 * rest.z());
    }
    bar.troubles.assign(n, {});
    for (std::size_t e = 0; e < n; ++e)
      if (testing::centroid(bar.mesh, e).x() < 0.5) bar.troubles[e].sharing = bar.troubles[e].shared_steps = 1;
    const std::vector<Quaternion> own(n, Quaternion::Identity());
    std::vector<Quaternion> shared = own;
    RecoveryReport report;
    share_rotations(bar.body, bar.positions, kPaceSeconds, bar.troubles, own, shared, report);
    const bool left_alone = stretch > kDrawnOut;
    EXPECT_EQ(report.elements == 0, left_alone);
    EXPECT_EQ(bar.sharing(), report.elements);
    EXPECT_EQ(bar.troubles.front().shared_steps == 0, left_alone) << "what was not tried does not count";
    EXPECT_EQ(shared.front().angularDistance(own.front()) == 0, left_alone);
  }
}

}  // namespace
}  // namespace softreel
