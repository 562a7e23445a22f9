/// The dial on motions whose errors are known: u + A h^p + B dt^q + C tolerance.
#include "core/dynamics/error_dial.h"

#include <cmath>

#include <gtest/gtest.h>

namespace softreel {
namespace {

struct KnownErrors {
  double mesh = 0.5, mesh_order = 1.5, time = 0.4, step_order = 2, algebra = 0.1;

  double mesh_error(std::int64_t tets) const {
    return mesh * std::pow(static_cast<double>(tets) / 500, -mesh_order / 3);
  }
  double time_error(int substeps) const { return time * std::pow(substeps, -step_order); }

  PilotRun pilots() const {
    return [*this](const Discretization& cut) -> std::optional<Motion> {
      return Motion{{Vec3(mesh_error(cut.tets), time_error(cut.substeps), algebra * cut.tolerance)}};
    };
  }
};

TEST(ErrorDial, BelievesWhatIsTrueWhereErrorsFollowPowers) {
  for (const double order : {1.1, 1.5, 1.9}) {
    KnownErrors known;
    known.mesh_order = order;
    const auto choice = turn_dial({.error = 0.05, .most_tets = 100000000}, known.pilots());
    ASSERT_TRUE(choice);
    EXPECT_NEAR(choice->believed.mesh / known.mesh_error(choice->chosen.tets), 1, 0.05) << order;
    EXPECT_NEAR(choice->believed.time / known.time_error(choice->chosen.substeps), 1, 0.05) << order;
    EXPECT_TRUE(choice->reached);
    EXPECT_LE(choice->believed.total(), 0.0506);
  }
}

TEST(ErrorDial, ASmallerErrorTakesMoreTetrahedraShorterStepsAndATighterSolver) {
  DialChoice before;
  for (const double error : {0.1, 0.05, 0.02}) {
    const auto choice = turn_dial({.error = error, .most_tets = 100000000}, KnownErrors{}.pilots());
    ASSERT_TRUE(choice);
    if (before.pilots > 0) {
      EXPECT_GT(choice->chosen.tets, before.chosen.tets);
      EXPECT_GT(choice->chosen.substeps, before.chosen.substeps);
      EXPECT_LT(choice->chosen.tolerance, before.chosen.tolerance);
    }
    before = *choice;
  }
}

TEST(ErrorDial, SaysWhatTheLimitsLeave) {
  const auto choice = turn_dial({.error = 1e-3, .most_tets = 20000, .most_substeps = 8}, KnownErrors{}.pilots());
  ASSERT_TRUE(choice);
  EXPECT_FALSE(choice->reached);
  EXPECT_EQ(choice->chosen.tets, 20000);
  EXPECT_EQ(choice->chosen.substeps, 8);
  EXPECT_NEAR(choice->believed.mesh / KnownErrors{}.mesh_error(20000), 1, 0.05);
}

TEST(ErrorDial, KeepsWhatIsGivenAndJudgesIt) {
  const auto choice = turn_dial({.error = 0.01, .given_tets = 40000, .given_substeps = 3, .given_tolerance = 1e-3},
                                KnownErrors{}.pilots());
  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->chosen.tets, 40000);
  EXPECT_EQ(choice->chosen.substeps, 3);
  EXPECT_EQ(choice->chosen.tolerance, 1e-3);
  EXPECT_NEAR(choice->believed.mesh / KnownErrors{}.mesh_error(40000), 1, 0.05);
  EXPECT_NEAR(choice->believed.time / KnownErrors{}.time_error(3), 1, 0.05);
}

TEST(ErrorDial, NothingIsChosenWhereNoPilotRuns) {
  EXPECT_FALSE(turn_dial({.error = 0.01}, [](const Discretization&) { return std::optional<Motion>(); }));
}

}  // namespace
}  // namespace softreel
