#include "tool/stages/heat_map.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/bcc_bar.h"

namespace softreel {
namespace {

/// A bar of 1 x 0.2 x 0.2 m with its nodes as surface.
struct Bar {
  FilledBody filled;
  std::vector<Vec3> points;
  std::vector<ElementMaterial> materials;
};

Bar make_bar() {
  Bar bar;
  bar.filled.mesh = testing::kuhn_bar({10, 2, 2}, Vec3(1, 0.2, 0.2));
  bar.points = bar.filled.mesh.nodes;
  bar.filled.embedding =
      embed_points(bar.points, std::vector<Vec3>(bar.points.size(), Vec3::UnitY()), bar.filled.mesh, Threads(1));
  bar.materials.resize(bar.filled.mesh.tets.size());
  for (ElementMaterial& m : bar.materials) {
    m.youngs_modulus = 2e5;
    m.poisson_ratio = 0.4;
  }
  return bar;
}

std::vector<double> heat(const Bar& bar, HeatQuantity quantity, const std::vector<Vec3>& nodes) {
  return heat_values(quantity, {bar.points, bar.filled, bar.materials, nodes}, Threads(1));
}

TEST(HeatValues, OfAUniformlyStretchedAndTurnedBarAreTheSameEverywhere) {
  const Bar bar = make_bar();
  // 10 % longer, as much thinner as a free bar gets, then turned and moved.
  const Mat3 stretch = Vec3(1.1, 0.96, 0.96).asDiagonal();
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  std::vector<Vec3> nodes;
  for (const Vec3& x : bar.points) nodes.push_back(turn * stretch * x + Vec3(3, 0, -1));
  for (const double value : heat(bar, HeatQuantity::Strain, nodes)) EXPECT_NEAR(value, 0.1, 1e-9);
  for (const double value : heat(bar, HeatQuantity::Stress, nodes)) EXPECT_NEAR(value, 2e4, 1e-3) << "E times strain";
}

TEST(HeatValues, DisplacementIsTheDistanceFromThePlaceAtRest) {
  const Bar bar = make_bar();
  std::vector<Vec3> nodes = bar.points;
  for (Vec3& x : nodes) x.y() += 0.5 * x.x();
  const std::vector<double> values = heat(bar, HeatQuantity::Displacement, nodes);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], 0.5 * bar.points[i].x(), 1e-12);
}

TEST(HeatValues, AreZeroAtRest) {
  const Bar bar = make_bar();
  for (const auto quantity : {HeatQuantity::Strain, HeatQuantity::Stress, HeatQuantity::Displacement})
    for (const double value : heat(bar, quantity, bar.points)) EXPECT_NEAR(value, 0, 1e-9);
}

TEST(RoundUp, GivesTheNextRoundNumber) {
  EXPECT_DOUBLE_EQ(round_up(1), 1);
  EXPECT_DOUBLE_EQ(round_up(1.01), 1.5);
  EXPECT_DOUBLE_EQ(round_up(0.0234), 0.025);
  EXPECT_DOUBLE_EQ(round_up(8.5e4), 1e5);
  EXPECT_DOUBLE_EQ(round_up(0.30000000000000004), 0.3) << "rounding is no reason for the next one";
}

TEST(UpperEnd, LeavesSinglePeaksOut) {
  std::vector<double> values(1000, 2.0);
  values[17] = 1e9;
  values[18] = std::numeric_limits<double>::quiet_NaN();
  SurfaceMesh surface;
  surface.positions.resize(values.size());
  for (Index v = 0; v < 1000; v += 2) surface.triangles.push_back({v, v + 1, 0});
  EXPECT_EQ(upper_end(values, surface), 2);
  EXPECT_EQ(upper_end({}, {}), 0);
}

TEST(UpperEnd, DoesNotSeeVerticesThatNoTriangleUses) {
  SurfaceMesh surface;
  surface.positions.resize(100);
  surface.triangles = {{0, 1, 2}};
  std::vector<double> values(100, 7.0);
  values[0] = values[1] = values[2] = 1;
  EXPECT_EQ(upper_end(values, surface), 1);
}

TEST(HeatLegendOf, SaysTheQuantityInAUnitOfItsSize) {
  EXPECT_EQ(heat_legend(HeatQuantity::Strain, {0, 0.25}).title, "Strain, %");
  EXPECT_EQ(heat_legend(HeatQuantity::Strain, {0, 0.25}).ticks.back().label, "25");
  EXPECT_EQ(heat_legend(HeatQuantity::Stress, {0, 2.5e4}).title, "Von Mises stress, kPa");
  EXPECT_EQ(heat_legend(HeatQuantity::Stress, {0, 2.5e4}).ticks.back().label, "25");
  EXPECT_EQ(heat_legend(HeatQuantity::Displacement, {0, 0.3}).title, "Displacement, cm");
}

}  // namespace
}  // namespace softreel
