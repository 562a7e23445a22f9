/// Equilibria, and rest, where something is far stiffer than the body: what is soft still hangs under its weight.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/glued_bars.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;

ElementMaterial bar_material(double youngs_modulus = 1e6) {
  ElementMaterial material;
  material.youngs_modulus = youngs_modulus;
  material.poisson_ratio = 0.3;
  return material;
}

std::vector<Index> held_end(const TetMesh& mesh) {
  return testing::select_nodes(mesh, [](const Vec3& p) { return p.x() < 1e-9; });
}

/// A bar of 0.6 x 0.2 x 0.2 m on springs of such a stiffness at its left end.
BodyModel sprung_bar(double stiffness) {
  BodyModel model = body_model(testing::kuhn_bar({6, 2, 2}, Vec3(0.6, 0.2, 0.2)), bar_material());
  model.pulls = {testing::make_pull(held_end(model.mesh), {}, stiffness)};
  return model;
}

double lowest_move(const BodyModel& model, const Simulator& simulator) {
  double lowest = 0;
  for (std::size_t i = 0; i < model.mesh.nodes.size(); ++i)
    lowest = std::min(lowest, simulator.state().positions[i].y() - model.mesh.nodes[i].y());
  return lowest;
}

TEST(StiffStatics, ABarOnStiffSpringsSagsAsOneThatIsHeld) {
  const auto sag = [](double stiffness) {
    const BodyModel model = sprung_bar(stiffness);
    Bench bench(model);
    const StepReport report = bench.simulator.find_equilibrium(1);
    EXPECT_TRUE(report.ok()) << stiffness << " " << report.culprit;
    return lowest_move(model, bench.simulator);
  };
  const double held = sag(1e12);
  EXPECT_LT(held, -0.01);
  for (const double stiffness : {1e15, 3e15, 1e17, 1e18, 1e20})
    EXPECT_NEAR(sag(stiffness) / held, 1, 1e-4) << stiffness << ": its rounding says nothing about the rest of the bar";
}

TEST(StiffStatics, ABarOnStiffSpringsIsNotAtRestBeforeItSagged) {
  for (const double stiffness : {1e12, 1e18, 1e20}) {
    const BodyModel model = sprung_bar(stiffness);
    Bench bench(model);
    EXPECT_FALSE(bench.simulator.step(1, 1 / testing::kFps).at_rest) << stiffness;
    EXPECT_LT(lowest_move(model, bench.simulator), -1e-3) << stiffness;
  }
}

TEST(StiffStatics, ABodyThatNothingBendsIsAtRestOnStiffSprings) {
  for (const double stiffness : {1e3, 1e9, 1e18}) {
    BodyModel model = sprung_bar(stiffness);
    model.gravity.setZero();
    Bench bench(model);
    EXPECT_TRUE(bench.simulator.step(1, 1 / testing::kFps).at_rest) << stiffness;
  }
}

TEST(StiffStatics, GlueTooStiffToBeSolvedIsNamedAndHidesNoWeight) {
  const Vec3 size(0.3, 0.2, 0.2);
  BodyModel left = testing::moved_model(testing::kuhn_bar({3, 2, 2}, size), bar_material(), Vec3::Zero(), "left");
  left.pins = {testing::make_pin(held_end(left.mesh))};
  BodyModel model = testing::glued(
      left, testing::moved_model(testing::kuhn_bar({3, 2, 2}, size), bar_material(), Vec3(0.3, 0, 0), "right"), 1e-3);
  for (const double stiffness : {1e13, 1e15}) {
    model.glues[0].stiffness = testing::constant(stiffness);
    Bench bench(model);
    const StepReport report = bench.simulator.find_equilibrium(1);
    if (report.ok()) {
      EXPECT_LT(lowest_move(model, bench.simulator), -0.01) << stiffness;
    } else {
      EXPECT_EQ(report.culprit.find("glue[0]: its stiffness of"), 0U) << report.culprit;
    }
  }
}

TEST(StiffStatics, APartAsGoodAsRigidTurnsWithTheSoftOneThatCarriesIt) {
  const auto sag = [](double stiffer) {
    BodyModel model = body_model(testing::kuhn_bar({8, 2, 2}, Vec3(0.8, 0.2, 0.2)), bar_material(1e5));
    for (std::size_t e = 0; e < model.mesh.tets.size(); ++e)
      if (testing::centroid(model.mesh, e).x() > 0.4) model.materials[e].youngs_modulus *= stiffer;
    model.gravity = Vec3(0, -1, 0);
    model.pins = {testing::make_pin(held_end(model.mesh))};
    Bench bench(model);
    const StepReport report = bench.simulator.find_equilibrium(1);
    EXPECT_TRUE(report.ok()) << stiffer << " " << report.culprit;
    EXPECT_LT(report.nonlinear_iterations, 40) << stiffer;
    return lowest_move(model, bench.simulator);
  };
  const double rigid = sag(1e4);
  EXPECT_LT(rigid, -0.02) << "it turns";
  for (const double stiffer : {1e6, 1e7, 1e8}) EXPECT_NEAR(sag(stiffer) / rigid, 1, 1e-3) << stiffer;
}

}  // namespace
}  // namespace softreel
