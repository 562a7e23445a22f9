#include "render/preview/corner_vertices.h"

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// A square of two triangles, (0, 1, 2) and (0, 2, 3).
MotionMesh textured_square() {
  MotionMesh mesh = square(1, 0, matte(0.5f));
  mesh.coloring.coordinates = {Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1), Vec2f(5, 5)};
  mesh.coloring.triangles = mesh.triangles;
  return mesh;
}

void expect_same_corners(const MotionMesh& mesh, const CornerVertices& corners) {
  ASSERT_EQ(corners.triangles.size(), mesh.triangles.size());
  ASSERT_EQ(corners.vertex_of.size(), corners.coordinate_of.size());
  ASSERT_EQ(corners.vertex_of.size(), corners.normal_of.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(corners.vertex_of[static_cast<std::size_t>(corners.triangles[t][k])], mesh.triangles[t][k]);
}

TEST(CornerVertices, AreThoseOfTheMeshWhereThereIsNoSeam) {
  const MotionMesh mesh = textured_square();
  const CornerVertices corners = split_at_seams(mesh);
  expect_same_corners(mesh, corners);
  EXPECT_EQ(corners.vertex_of.size(), 4U);
}

TEST(CornerVertices, AreSplitWhereCoordinatesDiffer) {
  MotionMesh mesh = textured_square();
  mesh.coloring.triangles[1] = {0, 4, 3};  // vertex 2 has two coordinates
  const CornerVertices corners = split_at_seams(mesh);
  expect_same_corners(mesh, corners);
  EXPECT_EQ(corners.vertex_of.size(), 5U);
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(corners.coordinate_of[static_cast<std::size_t>(corners.triangles[t][k])],
                mesh.coloring.triangles[t][k]);
}

TEST(CornerVertices, AreSplitWhereNormalsDiffer) {
  MotionMesh mesh = hard_cube(1, matte(0.5f));
  const CornerVertices corners = split_at_seams(mesh), own = split_all_corners(mesh);
  EXPECT_EQ(corners.vertex_of.size(), 24U) << "eight vertices of three sides each";
  for (const CornerVertices* split : {&corners, &own}) {
    expect_same_corners(mesh, *split);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const Index corner : split->triangles[t])
        EXPECT_EQ(split->normal_of[static_cast<std::size_t>(corner)], static_cast<Index>(t / 2));
  }
  mesh.normal_triangles = {};
  EXPECT_EQ(split_at_seams(mesh).vertex_of.size(), 8U);
}

TEST(CornerVertices, ATriangleThatLacksOneCoordinateHasNone) {
  MotionMesh mesh = textured_square();
  mesh.coloring.triangles[1] = {0, -1, 3};
  const CornerVertices corners = split_at_seams(mesh);
  expect_same_corners(mesh, corners);
  for (const Index corner : corners.triangles[1])
    EXPECT_EQ(corners.coordinate_of[static_cast<std::size_t>(corner)], -1);
  for (const Index corner : corners.triangles[0]) EXPECT_GE(corners.coordinate_of[static_cast<std::size_t>(corner)], 0);
}

TEST(CornerVertices, OfLinesAreTheirTrianglesOwn) {
  MotionMesh mesh = square(1, 0, matte(0.5f));
  const CornerVertices corners = split_all_corners(mesh);
  expect_same_corners(mesh, corners);
  EXPECT_EQ(corners.vertex_of.size(), 6U);
  mesh.lines.emplace();
  mesh.lines->drawn = {0b011, 0b111};
  const std::vector<Vec3f> weights = edge_weights(mesh);
  // The edge from corner 2 to corner 0 is not drawn: the weight of corner 1 is never small.
  EXPECT_EQ(weights[0], Vec3f(1, 1, 0));
  EXPECT_EQ(weights[1], Vec3f(0, 2, 0));
  EXPECT_EQ(weights[2], Vec3f(0, 1, 1));
  for (int k = 0; k < 3; ++k) EXPECT_EQ(weights[static_cast<std::size_t>(3 + k)], Vec3f::Unit(k));
  for (const Vec3f& n : face_normals(mesh.times[0].positions, mesh.triangles)) EXPECT_EQ(n, Vec3f(0, 1, 0));
}

}  // namespace
}  // namespace softreel
