#include "core/mesh/corner_normals.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/mesh/edge_angles.h"
#include "tests/core/mesh/mesh_files.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

using testing::unit_box;

constexpr double kDegree = std::numbers::pi / 180;

Vec3 direction_of(const SurfaceMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  const Vec3& p = mesh.positions[at(a)];
  return (mesh.positions[at(b)] - p).cross(mesh.positions[at(c)] - p).normalized();
}

/// Whether numbers are within bounds, at the vertices of their triangles, and each vertex has its own number.
void expect_sound(const CornerNormals& corners, const SurfaceMesh& mesh) {
  ASSERT_EQ(corners.triangles.size(), mesh.triangles.size());
  ASSERT_EQ(corners.normals.size(), corners.vertex_of.size());
  ASSERT_GE(corners.normals.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) EXPECT_EQ(at(corners.vertex_of[v]), v);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(corners.vertex_of.at(at(corners.triangles[t][k])), mesh.triangles[t][k]);
  for (const Vec3& n : corners.normals) EXPECT_NEAR(n.norm(), 1, 1e-15);
}

TEST(CornerNormals, OfACubeAreTwentyFourAndExactlyThoseOfItsFaces) {
  const SurfaceMesh mesh = unit_box();
  const CornerNormals corners = corner_normals(mesh, 40 * kDegree);
  expect_sound(corners, mesh);
  EXPECT_EQ(corners.normals.size(), 24u);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index n : corners.triangles[t]) EXPECT_EQ(corners.normals[at(n)], direction_of(mesh, t)) << t;
  std::vector<Vec3> sums(8, Vec3::Zero());
  for (std::size_t n = 0; n < 24; ++n) sums[at(corners.vertex_of[n])] += corners.normals[n];
  for (std::size_t v = 0; v < 8; ++v)
    EXPECT_EQ(sums[v], Vec3(2 * mesh.positions[v] - Vec3::Ones())) << "one of each side";
}

TEST(CornerNormals, OfACubeWhoseFileHasASideAtATimeAreTheSame) {
  const SurfaceMesh mesh = test::make_box(Vec3(1, 2, 3), 3, Vec3(0.1, 0.2, 0.3));
  const CornerNormals corners = corner_normals(mesh, 40 * kDegree);
  expect_sound(corners, mesh);
  EXPECT_EQ(corners.normals.size(), mesh.positions.size()) << "each vertex is of one side";
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index n : corners.triangles[t]) EXPECT_EQ(corners.normals[at(n)], direction_of(mesh, t)) << t;
}

TEST(CornerNormals, AreNoneWhereEveryEdgeIsAsSmoothAsTheAngle) {
  SurfaceMesh mesh = unit_box();
  EXPECT_FALSE(corner_normals(mesh, 89.9 * kDegree).empty());
  EXPECT_TRUE(corner_normals(mesh, 90 * kDegree).empty()) << "more than the angle is hard, not the angle itself";
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  for (Vec3& p : mesh.positions) p = (turn * p).cast<float>().cast<double>();
  EXPECT_TRUE(corner_normals(mesh, 90 * kDegree).empty()) << "in the precision of files";
  EXPECT_TRUE(corner_normals(test::make_sphere(1, 8, Vec3::Zero()), 30 * kDegree).empty());
  EXPECT_TRUE(corner_normals(test::make_torus(1, 0.4, 48, 24, Vec3::Zero()), 30 * kDegree).empty());
}

TEST(CornerNormals, OfARoundBodyBesideAHardOneKeepTheirBits) {
  SurfaceMesh mesh = test::make_sphere(1, 8, Vec3::Zero());
  const std::size_t round = mesh.positions.size(), round_triangles = mesh.triangles.size();
  test::append(mesh, test::make_box(Vec3::Ones(), 2, Vec3(5, 0, 0)));
  const CornerNormals corners = corner_normals(mesh, 30 * kDegree);
  expect_sound(corners, mesh);
  const std::vector<Vec3> smooth = vertex_normals(mesh, mesh.positions);
  for (std::size_t v = 0; v < round; ++v) EXPECT_EQ(corners.normals[v], smooth[v]) << v;
  for (std::size_t t = 0; t < round_triangles; ++t) EXPECT_EQ(corners.triangles[t], mesh.triangles[t]);
}

/// A cylinder about y of a radius, from y = 0 to 1: its caps are fans, its mantle has two triangles a side.
SurfaceMesh cylinder(Index sides, double radius) {
  std::vector<Vec3> positions{Vec3(0, 0, 0), Vec3(0, 1, 0)};
  std::vector<Triangle> triangles;
  for (Index i = 0; i < sides; ++i)
    for (const double y : {0.0, 1.0}) {
      const double turn = 360 * kDegree * i / sides;
      positions.emplace_back(radius * std::cos(turn), y, -radius * std::sin(turn));
    }
  for (Index i = 0; i < sides; ++i) {
    const Index low = 2 + 2 * i, high = low + 1, next_low = 2 + 2 * ((i + 1) % sides), next_high = next_low + 1;
    triangles.insert(triangles.end(), {{0, next_low, low}, {1, high, next_high}});
    triangles.insert(triangles.end(), {{low, next_low, next_high}, {low, next_high, high}});
  }
  return testing::make_mesh(positions, triangles);
}

TEST(CornerNormals, OfACylinderAreHardAtItsCapsAndRoundOnItsMantle) {
  constexpr Index kSides = 24;
  const SurfaceMesh mesh = cylinder(kSides, 0.5);
  const CornerNormals corners = corner_normals(mesh, 40 * kDegree);
  expect_sound(corners, mesh);
  EXPECT_EQ(corners.normals.size(), 2u + 4u * kSides) << "two at each vertex of a rim";
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& n = corners.normals[at(corners.triangles[t][k])];
      const Vec3& p = mesh.positions[at(mesh.triangles[t][k])];
      if (t % 4 < 2) {
        EXPECT_EQ(n, Vec3(0, t % 4 == 0 ? -1 : 1, 0));
        continue;
      }
      // Straight out, though one of the two sides has two triangles at the vertex and the other one: angles weigh.
      EXPECT_NEAR((n - Vec3(p.x(), 0, p.z()).normalized()).norm(), 0, 1e-14);
    }
}

TEST(CornerNormals, ANeedleBlursNoEdge) {
  // One side of an edge of the cube has a vertex in its middle; a needle without area closes the rest.
  SurfaceMesh mesh = unit_box();
  const auto middle = static_cast<Index>(mesh.positions.size());
  const Triangle cut = mesh.triangles[0];
  std::size_t k = 0;  // an edge of the cube, not the diagonal of a side
  while ((mesh.positions[at(cut[k])] - mesh.positions[at(cut[(k + 1) % 3])]).norm() > 1.2) ++k;
  const Index a = cut[k], b = cut[(k + 1) % 3], c = cut[(k + 2) % 3];
  mesh.positions.push_back(0.5 * (mesh.positions[at(a)] + mesh.positions[at(b)]));
  mesh.triangles[0] = {a, middle, c};
  mesh.triangles.insert(mesh.triangles.end(), {{middle, b, c}, {a, b, middle}});
  const CornerNormals corners = corner_normals(mesh, 40 * kDegree);
  expect_sound(corners, mesh);
  EXPECT_EQ(corners.normals.size(), 26u) << "the new vertex has one of each side, too";
  for (std::size_t t = 0; t + 1 < mesh.triangles.size(); ++t)
    for (const Index n : corners.triangles[t]) EXPECT_EQ(corners.normals[at(n)], direction_of(mesh, t)) << t;
}

TEST(CornerNormals, OfManyTrianglesAtAnEdgeAreTheirOwn) {
  std::vector<Vec3> positions{Vec3(0, 0, 0), Vec3(0, 1, 0)};
  std::vector<Triangle> triangles;
  for (Index i = 0; i < 40; ++i) {
    positions.emplace_back(std::cos(0.1 * i), 0, std::sin(0.1 * i));
    triangles.push_back({0, 1, 2 + i});
  }
  const SurfaceMesh mesh = testing::make_mesh(positions, triangles);
  const CornerNormals corners = corner_normals(mesh, 40 * kDegree);
  expect_sound(corners, mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_LT((corners.normals[at(corners.triangles[t][k])] - direction_of(mesh, t)).norm(), 1e-15);
}

TEST(MeasureEdges, TellsSharpFromBent) {
  const EdgeLengths box = measure_edges(unit_box(), 25 * kDegree, 40 * kDegree);
  EXPECT_NEAR(box.all, 12 + 6 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(box.sharp, 12, 1e-12);
  EXPECT_EQ(box.bent, 0);
  const EdgeLengths round = measure_edges(cylinder(12, 0.5), 25 * kDegree, 40 * kDegree);
  EXPECT_NEAR(round.bent, 12, 1e-12) << "the mantle's edges, of 30 degrees";
  EXPECT_NEAR(round.sharp, 24 * std::sin(15 * kDegree), 1e-12) << "the two rims";
}

}  // namespace
}  // namespace softreel
