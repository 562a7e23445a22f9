/// Equilibria of bodies whose weight is more than what holds them can carry.
#include "core/dynamics/holding.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/glued_bars.h"

namespace softreel {
namespace {

using testing::Bench;

constexpr double kWeight = 1000 * 0.4 * 0.2 * 0.2 * 9.81;  ///< N, of a bar

ElementMaterial hung_material() {
  ElementMaterial material;
  material.youngs_modulus = 1e6;
  material.poisson_ratio = 0.3;
  return material;
}

BodyModel bar(const Vec3& offset, const char* name) {
  return testing::moved_model(testing::kuhn_bar({4, 2, 2}, Vec3(0.4, 0.2, 0.2)), hung_material(), offset, name);
}

/// Held by pulls of these greatest forces at all of its points.
BodyModel hanging_bar(const std::vector<double>& max_forces) {
  BodyModel model = bar(Vec3::Zero(), "body.bar");
  for (const double max_force : max_forces) {
    model.pulls.push_back(testing::make_pull(testing::all_points(model), {}, 1e5));
    model.pulls.back().max_force = max_force;
  }
  return model;
}

std::string refusal(const BodyModel& model) {
  try {
    Bench(model).simulator.find_equilibrium(3);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    return error.what();
  }
  return {};
}

void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
}

TEST(Holding, PullsThatCannotCarryABodyAreSaidWithItsWeight) {
  expect_parts(refusal(hanging_bar({50, 60})),
               {"body.bar", "frame 3", "max_force = 110 N in all", "the body", "weighs 156.96 N", "Accepted", "Raise"});
}

TEST(Holding, GlueThatCannotCarryABodyIsSaidWithItsWeight) {
  BodyModel held = bar(Vec3::Zero(), "left");
  held.pins = {testing::make_pin(testing::select_nodes(held.mesh, [](const Vec3& p) { return p.x() < 1e-9; }))};
  BodyModel model = testing::glued(held, bar(Vec3(0.4, 0, 0), "right"), 1e-3);
  model.glues[0].max_force = 30;
  expect_parts(refusal(model), {"frame 3", "max_force = 30 N in all", "piece 1 of the body", "weighs 156.96 N"});
}

TEST(Holding, WhatCarriesTheWeightIsEnough) {
  BodyModel model = hanging_bar({0.6 * kWeight, 0.6 * kWeight});
  Bench bench(model);
  EXPECT_TRUE(bench.simulator.find_equilibrium(1).ok());
  BodyModel unlimited = hanging_bar({50, 0});
  EXPECT_EQ(refusal(unlimited), "") << "the second pull has no limit";
  BodyModel pinned = hanging_bar({50});
  pinned.pins = {testing::make_pin({0})};
  EXPECT_EQ(refusal(pinned), "");
  BodyModel weightless = hanging_bar({50});
  weightless.gravity.setZero();
  EXPECT_EQ(refusal(weightless), "");
}

TEST(Holding, APullThatIsAtItsLimitIsToBlame) {
  BodyModel model = hanging_bar({1.001 * kWeight});
  Transform away;
  away.translate = Vec3(0, -3, 0);
  model.pulls[0].track = testing::constant(away);
  SolverParams params;
  params.max_newton_iterations = 1;
  Bench bench(model, params);
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.culprit.find("body.bar.pull[0]: it pulls with all of its max_force of 157.117 N"), 0U)
      << report.culprit;
}

}  // namespace
}  // namespace softreel
