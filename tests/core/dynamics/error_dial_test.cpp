/// The dial on motions whose errors are known: u + A h^p + B dt^q + C tolerance.
#include "core/dynamics/error_dial.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace softreel {
namespace {

struct KnownErrors {
  double mesh = 0.3, mesh_order = 1.5, time = 0.4, step_order = 2, algebra = 0.1;

  double mesh_error(std::int64_t tets) const {
    return mesh * std::pow(static_cast<double>(tets) / 500, -mesh_order / 3);
  }
  double time_error(int substeps) const { return time * std::pow(substeps, -step_order); }

  PilotRun pilots() const {
    return [*this](const Discretization& cut) -> std::optional<SampledMotion> {
      return SampledMotion{{Vec3(mesh_error(cut.tets), time_error(cut.substeps), algebra * cut.tolerance)}};
    };
  }
};

TEST(ErrorDial, BelievesWhatIsTrueWhereErrorsFollowPowers) {
  for (const double order : {1.1, 1.5, 1.9}) {
    KnownErrors known;
    known.mesh_order = order;
    const auto choice = turn_dial({.error = 0.05, .most_tets = 100000000}, known.pilots());
    ASSERT_TRUE(choice);
    EXPECT_NEAR(choice->mesh_order, order, 0.05);
    EXPECT_NEAR(choice->believed.mesh / known.mesh_error(choice->chosen.tets), 1, 0.05) << order;
    EXPECT_NEAR(choice->believed.time / known.time_error(choice->chosen.substeps), 1, 0.05) << order;
    EXPECT_TRUE(choice->reached);
    EXPECT_LE(choice->believed.total(), 0.0506);
  }
}

/// Errors of the first order that scatter by a fifth, as pins that hold whole tetrahedra make them.
PilotRun scattered(unsigned seed) {
  return [seed](const Discretization& cut) -> std::optional<SampledMotion> {
    std::mt19937 random(seed + static_cast<unsigned>(cut.tets));
    const double scatter = std::uniform_real_distribution<>(0.8, 1.2)(random);
    return SampledMotion{
        {Vec3(KnownErrors{.mesh_order = 1}.mesh_error(cut.tets) * scatter, KnownErrors{}.time_error(cut.substeps), 0)}};
  };
}

TEST(ErrorDial, ASmallerErrorNeverTakesFewerTetrahedraOrLongerSteps) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    DialChoice before;
    for (double error = 0.3; error > 0.005; error /= 1.3) {
      const auto choice = turn_dial({.error = error}, scattered(seed));
      ASSERT_TRUE(choice);
      EXPECT_GE(choice->chosen.tets, before.chosen.tets) << seed << " " << error;
      EXPECT_GE(choice->chosen.substeps, before.chosen.substeps) << seed << " " << error;
      before = *choice;
    }
    EXPECT_GT(before.chosen.tets, 10000);
    EXPECT_GT(before.chosen.substeps, 10);
  }
}

TEST(ErrorDial, MostlyBelievesNearlyWhatIsTrueWhereErrorsScatter) {
  int within = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const auto choice = turn_dial({.error = 0.05}, scattered(seed));
    ASSERT_TRUE(choice);
    const double truth = KnownErrors{.mesh_order = 1}.mesh_error(choice->chosen.tets);
    within += choice->believed.mesh > truth / 2 && choice->believed.mesh < truth * 2 ? 1 : 0;
  }
  EXPECT_GE(within, 30);
}

TEST(ErrorDial, PilotsOfAFineRunCostAPartOfIt) {
  for (const double error : {0.02, 0.01, 0.005}) {
    double work = 0;
    const PilotRun known = KnownErrors{.mesh_order = 1.3}.pilots();
    const auto choice =
        turn_dial({.error = error, .dynamic = false, .most_tets = 100000000}, [&](const Discretization& cut) {
          work += static_cast<double>(cut.tets) * cut.substeps;
          return known(cut);
        });
    ASSERT_TRUE(choice);
    const double run = static_cast<double>(choice->chosen.tets) * choice->chosen.substeps;
    EXPECT_NEAR(choice->pilot_share, work / run, 1e-12);
    EXPECT_GT(run, 100000);
    EXPECT_LT(choice->pilot_share, 0.75);
  }
}

/// Coarse meshes and long steps are off along the same line: to opposite sides of the truth, or to the same.
PilotRun on_a_line(double side_of_steps) {
  return [side_of_steps](const Discretization& cut) -> std::optional<SampledMotion> {
    const KnownErrors known;
    const double off = known.mesh_error(cut.tets) + side_of_steps * known.time_error(cut.substeps);
    return SampledMotion{{Vec3(off, 0, 0), Vec3(0, off, 0)}, {Vec3(1, 2, 3), Vec3(4, 5, 6)}};
  };
}

TEST(ErrorDial, AddsErrorsOfMeshAndStepsByTheirDirections) {
  for (const double side : {-1.0, 1.0}) {
    const auto choice = turn_dial({.error = 0.05, .most_tets = 100000000}, on_a_line(side));
    ASSERT_TRUE(choice);
    const double mesh = KnownErrors{}.mesh_error(choice->chosen.tets);
    const double time = KnownErrors{}.time_error(choice->chosen.substeps);
    EXPECT_GT(time, 0.1 * mesh);
    EXPECT_NEAR(choice->believed.total() / std::abs(mesh + side * time), 1, 0.1) << side;
  }
  const auto across = turn_dial({.error = 0.05, .most_tets = 100000000}, KnownErrors{}.pilots());
  ASSERT_TRUE(across);
  const ErrorParts& parts = across->believed;
  EXPECT_NEAR(parts.total() - parts.algebra, std::hypot(parts.mesh, parts.time), 1e-4);
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
  int runs = 0;
  EXPECT_FALSE(turn_dial({.error = 0.01}, [&](const Discretization&) {
    ++runs;
    return std::optional<SampledMotion>();
  }));
  EXPECT_LE(runs, 10) << "a shot that cannot be simulated is not tried on ever finer meshes";
}

}  // namespace
}  // namespace softreel
