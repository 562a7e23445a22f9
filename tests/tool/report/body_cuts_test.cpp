#include "tool/report/body_cuts.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/bcc_bar.h"
#include "tool/report/cut_colors.h"

namespace softreel {
namespace {

constexpr int kWidth = 640;

/// The box [0, 4] x [0, 2] x [0, 2] of Kuhn's tetrahedra.
TetMesh bar() {
  return testing::kuhn_bar({4, 2, 2}, Vec3(4, 2, 2));
}

std::vector<MotionMesh> meshes_of(const BodyCuts& cuts, std::size_t body, const std::vector<Vec3>& nodes,
                                  const std::vector<float>& heat = {}) {
  std::vector<MotionMesh> meshes;
  cuts.add_meshes(body, nodes, heat, kWidth, meshes);
  return meshes;
}

double area_of(const MotionMesh& mesh) {
  const auto& p = mesh.times.back().positions;
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += 0.5 * static_cast<double>((p[static_cast<std::size_t>(t[1])] - p[static_cast<std::size_t>(t[0])])
                                         .cross(p[static_cast<std::size_t>(t[2])] - p[static_cast<std::size_t>(t[0])])
                                         .norm());
  return sum;
}

TEST(BodyCuts, LayBareTheInsideWhereTheBodyIsCutAtRest) {
  const TetMesh mesh = bar();
  const BodyCuts cuts({&mesh}, "x=0.5");  // between two layers of cells: the cut is flat
  const std::vector<MotionMesh> meshes = meshes_of(cuts, 0, mesh.nodes);
  ASSERT_EQ(meshes.size(), 2U);
  EXPECT_NEAR(area_of(meshes[0]), 4 + 4 * 4, 1e-5) << "one end and the sides of the half that is kept";
  EXPECT_NEAR(area_of(meshes[1]), 4, 1e-5) << "the cut";
  for (const Vec3f& p : meshes[1].times[0].positions) EXPECT_EQ(p.x(), 2);
  for (const MotionMesh& part : meshes) {
    ASSERT_TRUE(part.lines.has_value());
    EXPECT_FLOAT_EQ(part.lines->width, kCutLineWidth * kWidth / 1600);
    EXPECT_TRUE(part.times[0].normals.empty()) << "faces are flat";
  }
}

TEST(BodyCuts, ShowTheSameElementsHoweverTheyMove) {
  const TetMesh mesh = bar();
  const BodyCuts cuts({&mesh}, "-x=0.3");
  std::vector<Vec3> moved = mesh.nodes;
  for (Vec3& node : moved) node = Vec3(-10 + node.y(), 3 * node.x(), node.z());
  const std::vector<MotionMesh> rest = meshes_of(cuts, 0, mesh.nodes), later = meshes_of(cuts, 0, moved);
  ASSERT_EQ(rest.size(), later.size());
  for (std::size_t m = 0; m < rest.size(); ++m) {
    EXPECT_EQ(rest[m].triangles, later[m].triangles);
    for (std::size_t k = 0; k < rest[m].times[0].positions.size(); ++k) {
      const Vec3f at = rest[m].times[0].positions[k];
      EXPECT_EQ(later[m].times[0].positions[k], Vec3f(-10 + at.y(), 3 * at.x(), at.z()));
    }
  }
}

TEST(BodyCuts, TintTheCutByTheAnglesOfTheDeformedElements) {
  const TetMesh mesh = bar();
  const BodyCuts cuts({&mesh}, "x");
  const auto tints = [&](const std::vector<Vec3>& nodes) { return meshes_of(cuts, 0, nodes)[1].coloring.colors; };
  // The smallest dihedral angle of a Kuhn tetrahedron is 45 degrees: the tenth of 13 tints.
  for (const Vec3f& color : tints(mesh.nodes)) EXPECT_EQ(color, angle_tint_color(9));
  std::vector<Vec3> flat = mesh.nodes, inverted = mesh.nodes;
  for (Vec3& node : flat) node.y() *= 1e-6;
  for (Vec3& node : inverted) node.y() *= -1;
  for (const Vec3f& color : tints(flat)) EXPECT_EQ(color, angle_tint_color(0));
  for (const Vec3f& color : tints(inverted)) EXPECT_EQ(color, angle_tint_color(0)) << "inside out";
}

TEST(BodyCuts, GiveEachFaceTheHeatOfItsElement) {
  const TetMesh mesh = bar();
  const BodyCuts cuts({&mesh}, "x=0.5");
  std::vector<float> heat;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    heat.push_back(static_cast<float>(testing::centroid(mesh, e).z()) / 2);
  for (const MotionMesh& part : meshes_of(cuts, 0, mesh.nodes, heat)) {
    const std::vector<float>& shown = part.coloring.heat;
    ASSERT_EQ(shown.size(), part.times[0].positions.size());
    EXPECT_TRUE(part.coloring.colors.empty());
    for (std::size_t k = 0; k < shown.size(); k += 3) {
      EXPECT_EQ(shown[k], shown[k + 1]);
      EXPECT_EQ(shown[k], shown[k + 2]);
      float z = 0;
      for (std::size_t c = 0; c < 3; ++c) z += part.times[0].positions[k + c].z() / 3;
      EXPECT_NEAR(2 * shown[k], z, 0.5) << "an element is 1 wide";
    }
  }
}

TEST(BodyCuts, GoThroughAllBodiesAtOneHeight) {
  const TetMesh low = bar();
  TetMesh high = bar();
  for (Vec3& node : high.nodes) node.y() += 6;  // together from 0 to 8
  const BodyCuts cuts({&low, &high}, "y=0.5");
  EXPECT_EQ(meshes_of(cuts, 0, low.nodes).size(), 1U) << "whole: its boundary only";
  EXPECT_TRUE(meshes_of(cuts, 1, high.nodes).empty()) << "before the plane";
  EXPECT_TRUE(cuts.keeps(0, 0));
  EXPECT_FALSE(cuts.keeps(1, 0));
}

TEST(BodyCuts, RefuseAPlaneThatNothingLiesBehind) {
  const TetMesh mesh = bar();
  try {
    BodyCuts({&mesh}, "x=0");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    EXPECT_NE(std::string(error.what()).find("--cut x=0"), std::string::npos) << error.what();
  }
}

TEST(CutFacing, IsThePlaneSeenMostFaceOn) {
  EXPECT_EQ(cut_facing(Vec3(0.2, 0.1, 3)), "z");
  EXPECT_EQ(cut_facing(Vec3(-2, 1, 1)), "-x");
  EXPECT_EQ(cut_facing(Vec3(1, 2, 1)), "y");
}

}  // namespace
}  // namespace softreel
