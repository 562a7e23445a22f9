/// Energies over the frames in a run's report, against mechanics.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

struct Energies {
  std::vector<int> frames;
  std::vector<double> kinetic, elastic, gravity;
};

Energies simulated(const std::string& folder, const std::string& more) {
  const Outcome outcome =
      run(fmt::format("softreel simulate {0}/shot.toml --output {0}/out --quiet --json {1}", folder, more));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json body = json::parse(outcome.out)["energies"][0];
  return {body["frames"], body["kinetic"], body["elastic"], body["gravity"]};
}

constexpr double kGravity = 9.81, kDensity = 1000, kFps = 24;

/// No damping, no loss in the integrator: what the fall takes from gravity is all in the motion.
const std::string kFree =
    "--set body.ball.pin=[] --set body.ball.pull=[] --set solver.integrator=newmark --set material.soft.damping_mass=0 "
    "--set material.soft.damping_stiffness=0 --set material.soft.density=1000 --set solver.tolerance=1e-10 ";

TEST(Energies, ABallInFreeFallTurnsGravityIntoMotionAndIntoNothingElse) {
  const std::string folder = shot_folder("fall");
  const Energies found = simulated(folder, kFree + "--set shot.frames=[1,9]");
  ASSERT_EQ(found.frames, (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(found.kinetic[0], 0);
  EXPECT_EQ(found.elastic[0], 0);
  EXPECT_EQ(found.gravity[0], 0);
  const double seconds = 8 / kFps, speed = kGravity * seconds;
  // The ball is a polyhedron of tetrahedra: up to 15 % less than the sphere of 1 m.
  const double mass = kDensity * M_PI / 6;
  EXPECT_NEAR(found.kinetic[8], 0.5 * mass * speed * speed, 0.15 * 0.5 * mass * speed * speed);
  for (std::size_t k = 1; k < 9; ++k) {
    const double share = std::pow(static_cast<double>(k) / 8, 2);
    EXPECT_NEAR(found.kinetic[k], share * found.kinetic[8], 1e-6 * found.kinetic[8]);
    EXPECT_NEAR(found.kinetic[k] + found.gravity[k], 0, 1e-6 * found.kinetic[8]);
    EXPECT_NEAR(found.elastic[k], 0, 1e-6 * found.kinetic[8]);
  }
}

TEST(Energies, AStretchedBodyHoldsWhatIsPutIntoItAndNoMotion) {
  const std::string folder = shot_folder("statics");
  const auto stored = [&](double pull) {
    return simulated(
        folder, fmt::format("--set shot.mode=static --set gravity.acceleration=[0,0,0] --set body.ball.pull[0].keys="
                            "[{{frame=1}},{{frame=4,translate=[0,{},0]}}]",
                            pull));
  };
  const Energies small = stored(0.001), twice = stored(0.002);
  EXPECT_NEAR(small.elastic[0], 0, 1e-9 * small.elastic[3]);
  EXPECT_GT(small.elastic[3], 0);
  EXPECT_NEAR(twice.elastic[3] / small.elastic[3], 4, 0.1) << "energy goes with the square of a small pull";
  for (const double kinetic : twice.kinetic) EXPECT_EQ(kinetic, 0);
}

TEST(Energies, AreKeptFromRunToRunWhileTheirFramesStand) {
  const std::string folder = shot_folder("energies_kept");
  const Energies whole = simulated(folder, "--cache " + folder + "/other_cache");
  run(fmt::format("rm -r {0}/out", folder));
  EXPECT_EQ(simulated(folder, "--frames 1-2").frames, (std::vector<int>{1, 2}));
  const Energies continued = simulated(folder, "");
  EXPECT_EQ(continued.frames, whole.frames);
  EXPECT_EQ(continued.kinetic, whole.kinetic);
  EXPECT_EQ(continued.elastic, whole.elastic);
  EXPECT_EQ(simulated(folder, "").kinetic, whole.kinetic) << "and where nothing is simulated at all";
  run(fmt::format("rm {0}/out/ball.report.json", folder));
  EXPECT_EQ(simulated(folder, "").kinetic, whole.kinetic) << "nor if a killed run left no report";
  // Another material: none of the old numbers may stand beside the new ones.
  const Energies changed = simulated(folder, "--frames 1-3 --set material.soft.youngs_modulus=1e5");
  EXPECT_EQ(changed.frames, (std::vector<int>{1, 2, 3}));
  EXPECT_NE(changed.kinetic[2], whole.kinetic[2]);
}

}  // namespace
}  // namespace softreel
