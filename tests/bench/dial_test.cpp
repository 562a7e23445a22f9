/// The error dial on small bodies: what it believes beside what is true.
#include <gtest/gtest.h>

#include "tests/benchmark/dial/dial_study.h"

namespace softreel::bench {
namespace {

class ErrorDialOn : public ::testing::Test {
 protected:
  static void expect_honest(const DialProblem& problem) {
    const DialStudy study = study_dial(problem);
    const DialTurn* before = nullptr;
    for (const DialTurn& turn : study.turns) {
      const DialChoice& choice = turn.choice;
      const double ratio = turn.ratio();
      EXPECT_TRUE(ratio >= 0.5 && ratio <= 2)
          << turn.asked << ": believed " << choice.believed.total() << ", true " << turn.truth;
      EXPECT_NE(judge(turn, study.truth_doubt), Honesty::Outside) << turn.asked;
      EXPECT_TRUE(choice.reached) << turn.asked;
      EXPECT_LE(turn.truth, 2 * turn.asked);
      if (before != nullptr) {
        EXPECT_GE(choice.chosen.tets, before->choice.chosen.tets);
        EXPECT_GE(choice.chosen.substeps, before->choice.chosen.substeps);
        EXPECT_LT(turn.truth, before->truth);
      }
      before = &turn;
    }
    EXPECT_GT(before->choice.chosen.tets, study.turns.front().choice.chosen.tets);
  }
};

TEST_F(ErrorDialOn, ABendingBarBelievesWhatIsNearlyTrue) {
  expect_honest({"static_bar", "", 12, 0, 40000, {0.05, 0.01}});
}

TEST_F(ErrorDialOn, AFallingBarBelievesWhatIsNearlyTrue) {
  expect_honest({"falling_bar", "", 12, 0, 30000, {0.05, 0.02}});
}

TEST_F(ErrorDialOn, ATwistedBarBelievesWhatIsNearlyTrue) {
  expect_honest({"twist", "", 12, 0, 20000, {0.05, 0.01}});
}

TEST(ErrorDialJudged, SaysNothingWhereTheTruthIsNotKnownWellEnough) {
  DialTurn turn;
  turn.truth = 0.012;
  turn.choice.believed.mesh = 0.011;
  EXPECT_EQ(judge(turn, 0.009), Honesty::Undecided);
  EXPECT_EQ(judge(turn, 0.001), Honesty::Within);
  EXPECT_EQ(judge(turn, 0.02), Honesty::Undecided) << "the truth may be zero";
  turn.choice.believed.mesh = 0.004;
  EXPECT_EQ(judge(turn, 0.001), Honesty::Outside);
  EXPECT_EQ(judge(turn, 0.005), Honesty::Undecided);
  turn.choice.believed.mesh = 0.03;
  EXPECT_EQ(judge(turn, 0.001), Honesty::Outside);
  EXPECT_EQ(judge(turn, 0.004), Honesty::Undecided);
}

}  // namespace
}  // namespace softreel::bench
