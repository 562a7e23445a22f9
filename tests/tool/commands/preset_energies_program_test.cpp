/// The presets that move, at their full size, against themselves in steps of half the length: what a preset shows is
/// physics and not its steps.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

/// A preset and the one body to look at; empty: all.
struct Moving {
  std::string preset;
  std::string body = "";
};

std::string path_of(const Moving& moving) {
  return fmt::format("{}/presets/{}.toml", SOFTREEL_SOURCE_DIR, moving.preset);
}

int substeps_of(const Moving& moving) {
  const std::string shot = read_text(path_of(moving)), key = "\nsubsteps = ";
  const std::size_t at = shot.find(key);
  return at == std::string::npos ? 1 : std::stoi(shot.substr(at + key.size()));
}

/// Of the greatest energy: steps of first order differ by a fifth of it from those of half the length.
constexpr double kGreatestDifference = 0.3;

json energies(const std::string& folder, const Moving& moving, int substeps) {
  const Outcome outcome =
      run(fmt::format("softreel simulate '{}' --set solver.substeps={} --output {}/{} --quiet --json", path_of(moving),
                      substeps, folder, substeps));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return json::parse(outcome.out)["energies"];
}

class PresetEnergies : public ::testing::TestWithParam<Moving> {};

TEST_P(PresetEnergies, AreThoseOfStepsOfHalfTheLength) {
  const Moving& moving = GetParam();
  const std::string folder = new_folder("energies_" + moving.preset);
  const int substeps = substeps_of(moving);
  const json own = energies(folder, moving, substeps), fine = energies(folder, moving, 2 * substeps);
  ASSERT_EQ(own.size(), fine.size());
  int looked_at = 0;
  for (std::size_t b = 0; b < own.size(); ++b) {
    if (!moving.body.empty() && own[b]["body"] != moving.body) continue;
    ++looked_at;
    for (const char* kind : {"kinetic", "elastic"}) {
      const std::vector<double> with = own[b][kind], half = fine[b][kind];
      ASSERT_EQ(with.size(), half.size());
      const double greatest = *std::max_element(half.begin(), half.end());
      double difference = 0;
      for (std::size_t f = 0; f < half.size(); ++f) difference = std::max(difference, std::abs(with[f] - half[f]));
      EXPECT_LT(difference, kGreatestDifference * greatest) << own[b]["body"] << ", " << kind;
    }
  }
  EXPECT_GT(looked_at, 0);
}

// Of flutter's bodies two flutter: that is what it shows.
INSTANTIATE_TEST_SUITE_P(All, PresetEnergies,
                         ::testing::Values(Moving{"first_pull"}, Moving{"daylight"}, Moving{"flutter", "consistent"},
                                           Moving{"jelly_hat"}, Moving{"long_stretch"}, Moving{"pudding"},
                                           Moving{"puppet"}, Moving{"small_strain"}, Moving{"soft_knees"},
                                           Moving{"stiffness"}, Moving{"stress"}, Moving{"two_bodies"}),
                         [](const auto& moving) { return moving.param.preset; });

}  // namespace
}  // namespace softreel
