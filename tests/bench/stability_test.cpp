// Short versions of the torture: what must hold of the default, as assertions.
#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "tests/benchmark/stability/abuse_study.h"
#include "tests/benchmark/stability/held_pose.h"
#include "tests/benchmark/stability/methods.h"
#include "tests/benchmark/stability/scramble_study.h"

namespace softreel::bench {
namespace {

TEST(Stability, TheDefaultComesBackFromEveryScramble) {
  for (const testing::Scramble& scramble : testing::scrambles())
    for (int seed = 1; seed <= 4; ++seed) {
      const ScrambledRun run = run_scramble(2, scramble, RotationMethod::Consistent, true, seed, 100);
      EXPECT_TRUE(run.came_back) << scramble.name << ", seed " << seed << ": " << run.verdict.failure;
      EXPECT_EQ(run.left.inverted + run.left.wound, 0) << scramble.name << ", seed " << seed;
    }
}

TEST(Stability, NoMethodMakesNaNOfAScrambleOrLeavesAStepUnsolved) {
  for (const testing::Scramble& scramble : testing::scrambles())
    for (const NamedMethod& method : kMethods) {
      const ScrambledRun run = run_scramble(2, scramble, method.rotation, true, 7, 40);
      EXPECT_TRUE(run.verdict.finite) << scramble.name << ", " << method.name;
      EXPECT_FALSE(run.verdict.unsolved()) << scramble.name << ", " << method.name << ": " << run.verdict.failure;
      EXPECT_GT(run.verdict.steps, 0);
    }
}

TEST(Watch, SeesNumbersThatAreNone) {
  const Rig rig(make_cantilever_model({{2, 1, 1}}), {});
  const SimulationState good = rig.simulator.state();
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(is_finite(good));
  SimulationState bad = good;
  bad.positions[1].y() = none;
  EXPECT_FALSE(is_finite(bad));
  bad = good;
  bad.velocities[2].z() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_finite(bad));
  bad = good;
  bad.rotations[0].x() = none;
  EXPECT_FALSE(is_finite(bad));
}

TEST(Watch, TellsAStepThatWasNotSolvedFromNumbersThatAreNone) {
  Verdict verdict;
  EXPECT_TRUE(verdict.survived());
  EXPECT_FALSE(verdict.unsolved());
  verdict.failure = "step 1: element 3";
  EXPECT_TRUE(verdict.unsolved());
  verdict.finite = false;
  EXPECT_FALSE(verdict.unsolved());
}

TEST(Flutter, IsThatOfTheBodyWhateverTheMethodsRotationsAre) {
  for (const RotationMethod rotation : {RotationMethod::None, RotationMethod::Consistent}) {
    BodyModel model = make_cantilever_model({{8, 2, 2}});
    model.gravity = Vec3(0, -9.81, 0);
    SolverParams params;
    params.rotation = rotation;
    Rig rig(std::move(model), params);
    Watch watch(rig.simulator);
    EXPECT_GT(measure_flutter(watch, rig.simulator, 1, 1.0 / 24, 8), kFlutter);
  }
}

TEST(AbuseInAWord, NamesTheDriftOfFreeBodies) {
  AbuseResult result;
  EXPECT_EQ(in_a_word(result), "calm");
  result.verdict.angular_drift = 0.25;
  EXPECT_EQ(in_a_word(result), "calm") << "what holds the body takes momentum";
  result.free = true;
  result.flutter = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(in_a_word(result), "drift 0.25");
  result.verdict.worst_gain = 0.5;
  EXPECT_EQ(in_a_word(result), "gain 0.5, drift 0.25");
  result.verdict.angular_drift = 0.5 * kDrift;
  EXPECT_EQ(in_a_word(result), "gain 0.5");
  result.verdict.failure = "step 1: element 3";
  EXPECT_EQ(in_a_word(result), "stopped");
}

TEST(Stability, ThePaperWithoutSafeguardLeavesScramblesBehind) {
  int back = 0;
  for (int seed = 1; seed <= 4; ++seed)
    back += run_scramble(2, testing::scrambles()[0], RotationMethod::Paper, false, seed, 100).came_back ? 1 : 0;
  EXPECT_LT(back, 4) << "or coming back says nothing";
}

TEST(Stability, IteratedEulerNeverGainsEnergyAndSolvesEveryStep) {
  for (const testing::Scramble& scramble : testing::scrambles())
    for (const bool pinned : {false, true})
      for (int seed = 1; seed <= 2; ++seed) {
        const EnergyRun run = run_iterated(2, scramble, pinned, seed == 1, seed, 30);
        EXPECT_TRUE(run.verdict.survived()) << scramble.name << ", seed " << seed << ": " << run.verdict.failure;
        EXPECT_EQ(run.verdict.gains, 0) << scramble.name << ", seed " << seed << ": " << run.verdict.worst_gain;
        EXPECT_GT(run.judged, 10);
      }
}

TEST(Stability, ABarStretchedTwentyTimesRestsWithTheCapAndFluttersWithout) {
  const BarBody bar;
  SolverParams params;
  Verdict verdict;
  for (const HeldPose& pose : stretch_bar(bar, params, {2, 4, 8, 14, 20}, {}, verdict))
    EXPECT_LT(pose.flutter, kFlutter) << pose.asked;
  EXPECT_TRUE(verdict.survived()) << verdict.failure;
  params.dilatation = Dilatation::Linear;
  // Across a stretch of 1 + 1 / nu = 4.33 a linear bar is without thickness.
  const std::vector<HeldPose> linear = stretch_bar(bar, params, {2, 3, 5}, {}, verdict);
  ASSERT_EQ(linear.size(), 3U) << verdict.failure;
  EXPECT_LT(linear[1].flutter, kFlutter);
  EXPECT_GT(linear[2].flutter, 10);
}

TEST(Stability, OneSolveAStepKeepsStiffStretchedBarsAtRest) {
  // Without the stiffness of tension in its matrix: 46 and 71 degrees a step from stretch 3 and 2.
  for (const std::array<int, 3>& cells : {std::array<int, 3>{8, 4, 4}, {20, 2, 2}})
    for (const double modulus : {1e6, 1e8}) {
      BarBody bar{cells};
      bar.material.youngs_modulus = modulus;
      Verdict verdict;
      const std::vector<HeldPose> poses = stretch_bar(bar, {}, {1.25, 2, 5, 20}, {}, verdict);
      ASSERT_EQ(poses.size(), 4U) << verdict.failure;
      for (const HeldPose& pose : poses)
        EXPECT_LT(pose.flutter, 1e-6) << "degrees a step at stretch " << pose.asked << ", E = " << modulus;
    }
}

TEST(Stability, Bdf2KeepsAStretchedBarAtRestWhereItsStepIsShortForIt) {
  BarBody bar{{20, 2, 2}};
  bar.material.youngs_modulus = 1e6;
  SolverParams params;
  params.integrator = Integrator::Bdf2;
  Verdict verdict;
  for (const HeldPose& pose : stretch_bar(bar, params, {2, 20}, {96, 4}, verdict))
    EXPECT_LT(pose.flutter, 1e-6) << pose.asked;
  EXPECT_TRUE(verdict.survived()) << verdict.failure;
}

TEST(Stability, IterationKeepsAStiffSlenderBarAtRestToo) {
  BarBody bar{{8, 2, 2}};
  bar.material.youngs_modulus = 1e8;
  SolverParams params;
  params.linearize = Linearize::Iterated;
  Verdict verdict;
  for (const HeldPose& pose : stretch_bar(bar, params, {2, 8, 20}, {}, verdict))
    EXPECT_LT(pose.flutter, kFlutter) << pose.asked;
  EXPECT_TRUE(verdict.survived()) << verdict.failure;
}

TEST(Stability, ATwistedBarHoldsTwoTurns) {
  Verdict verdict;
  const auto poses = twist_bar({{40, 2, 2}}, {}, 2, 1.5, {}, verdict);
  ASSERT_EQ(poses.size(), 3U) << verdict.failure;
  for (const HeldPose& pose : poses) EXPECT_NEAR(pose.held, pose.asked, 1e-6);
}

TEST(Stability, TheDefaultSurvivesAllAbuseAndFreeBodiesKeepTheirMomentum) {
  for (Abuse& abuse : abuses(sliver_bar(0.1), true)) {
    abuse.steps = std::min(abuse.steps, 40);
    const AbuseResult result = run_abuse(abuse, {});
    EXPECT_TRUE(result.verdict.survived()) << abuse.name << ": " << result.verdict.failure;
    if (abuse.free) {
      EXPECT_LT(result.verdict.linear_drift, 1e-8) << abuse.name;
    }
    if (abuse.free && abuse.seconds < 2e-3) {
      EXPECT_LT(result.verdict.angular_drift, 1e-3) << abuse.name;
    }
  }
}

}  // namespace
}  // namespace softreel::bench
