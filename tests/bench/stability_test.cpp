// Short versions of the torture: what must hold of the default, as assertions.
#include <algorithm>

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

TEST(Stability, NoMethodMakesNaNOrAReflectionOfAScramble) {
  for (const testing::Scramble& scramble : testing::scrambles())
    for (const NamedMethod& method : kMethods) {
      const ScrambledRun run = run_scramble(2, scramble, method.rotation, true, 7, 40);
      EXPECT_TRUE(run.verdict.survived()) << scramble.name << ", " << method.name << ": " << run.verdict.failure;
    }
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
