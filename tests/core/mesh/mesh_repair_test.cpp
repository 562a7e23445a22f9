#include "core/mesh/mesh_repair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/mesh_check.h"
#include "tests/core/mesh/mesh_files.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

using testing::add_box;
using testing::make_mesh;
using testing::unit_box;

double volume(const SurfaceMesh& mesh) {
  return check_mesh(mesh).signed_volume;
}

TEST(RepairMesh, LeavesAGoodMeshAsItIs) {
  SurfaceMesh box = unit_box();
  const std::vector<Triangle> triangles = box.triangles;
  EXPECT_TRUE(repair_mesh(box).empty());
  EXPECT_EQ(box.triangles, triangles);
}

TEST(RepairMesh, RemovesJunkAndKeepsVerticesAndPolygons) {
  SurfaceMesh mesh = unit_box();
  const std::size_t polygons = mesh.polygons.size();
  mesh.positions.emplace_back(std::numeric_limits<double>::infinity(), 0, 0);
  for (const Triangle& junk : {Triangle{0, 1, 8}, Triangle{3, 3, 1}, mesh.triangles[4]}) {
    mesh.triangles.push_back(junk);
    mesh.triangle_polygon.push_back(0);
  }
  const std::vector<std::string> lines = repair_mesh(mesh);
  EXPECT_EQ(lines, std::vector<std::string>({"1 triangle(s) with coordinates that are not finite removed",
                                             "1 triangle(s) with two corners in one place removed",
                                             "1 duplicate triangle(s) removed"}));
  EXPECT_EQ(mesh.triangles, unit_box().triangles);
  EXPECT_EQ(mesh.triangle_polygon.size(), mesh.triangles.size());
  EXPECT_EQ(mesh.positions.size(), 9U);
  EXPECT_EQ(mesh.polygons.size(), polygons);
}

TEST(RepairMesh, TurnsAnySetOfFlippedTrianglesBackWithTheirTextures) {
  for (unsigned flipped = 0; flipped < 4096; flipped += 7) {
    SurfaceMesh mesh = unit_box();
    mesh.triangle_textures = mesh.triangles;
    for (std::size_t t = 0; t < 12; ++t)
      if ((flipped >> t & 1U) != 0) {
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        std::swap(mesh.triangle_textures[t][1], mesh.triangle_textures[t][2]);
      }
    repair_mesh(mesh);
    EXPECT_EQ(mesh.triangles, unit_box().triangles) << flipped;
    EXPECT_EQ(mesh.triangle_textures, mesh.triangles) << flipped;
  }
}

TEST(RepairMesh, TurnsSeparatePiecesOutward) {
  SurfaceMesh mesh;
  add_box(mesh, Vec3::Zero(), Vec3::Ones(), true);
  add_box(mesh, Vec3(2, 0, 0), Vec3(3, 1, 1), false);
  EXPECT_EQ(repair_mesh(mesh), std::vector<std::string>({"1 of 2 pieces turned outward"}));
  EXPECT_NEAR(volume(mesh), 2, 1e-14);
}

TEST(RepairMesh, KeepsACavityACavityAndASolidInASolidSolid) {
  for (const bool outer_inward : {false, true})
    for (const bool inner_inward : {false, true}) {
      SurfaceMesh mesh;
      add_box(mesh, Vec3::Constant(1), Vec3::Constant(2), inner_inward);  // the inner one first
      add_box(mesh, Vec3::Zero(), Vec3::Constant(3), outer_inward);
      repair_mesh(mesh);
      EXPECT_NEAR(volume(mesh), inner_inward == outer_inward ? 28 : 26, 1e-12);
    }
}

TEST(RepairMesh, KeepsASolidInsideACavity) {
  for (const bool inverted : {false, true}) {
    SurfaceMesh mesh;
    add_box(mesh, Vec3::Zero(), Vec3::Constant(5), inverted);
    add_box(mesh, Vec3::Constant(1), Vec3::Constant(4), !inverted);
    add_box(mesh, Vec3::Constant(2), Vec3::Constant(3), inverted);
    EXPECT_EQ(repair_mesh(mesh).empty(), !inverted);
    EXPECT_NEAR(volume(mesh), 125 - 27 + 1, 1e-12);
  }
}

TEST(RepairMesh, RemovesTheWallBetweenTwoBoxesWithBothSides) {
  SurfaceMesh mesh;
  add_box(mesh, Vec3::Zero(), Vec3::Ones());
  add_box(mesh, Vec3(1, 0, 0), Vec3(2, 1, 1));
  ASSERT_EQ(check_mesh(mesh).duplicate_triangles, 2);  // both sides are cut along the same diagonal
  EXPECT_EQ(repair_mesh(mesh), std::vector<std::string>({"4 triangle(s) of two-sided inner walls removed"}));
  EXPECT_TRUE(check_mesh(mesh).closed());
  EXPECT_NEAR(volume(mesh), 2, 1e-14);
}

TEST(RepairMesh, KeepsOneOfABodyThatIsThereTwiceWithOppositeFaces) {
  SurfaceMesh mesh = unit_box();
  for (Triangle t : unit_box().triangles) {
    std::swap(t[0], t[1]);
    mesh.triangles.push_back(t);
    mesh.triangle_polygon.push_back(0);
  }
  EXPECT_EQ(repair_mesh(mesh), std::vector<std::string>({"12 duplicate triangle(s) removed"}));
  EXPECT_TRUE(check_mesh(mesh).closed());
  EXPECT_NEAR(volume(mesh), 1, 1e-15);
}

TEST(RepairMesh, SaysThatAMoebiusStripHasOneSide) {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  constexpr Index kSteps = 12;
  for (Index i = 0; i < kSteps; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSteps, twist = angle / 2;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(twist);
      points.emplace_back(r * std::cos(angle), r * std::sin(angle), side * std::sin(twist));
    }
    const Index a = 2 * i, b = a + 1;
    const Index c = i + 1 < kSteps ? a + 2 : 1, d = i + 1 < kSteps ? a + 3 : 0;
    triangles.push_back({a, b, d});
    triangles.push_back({a, d, c});
  }
  SurfaceMesh mesh = make_mesh(points, triangles);
  const std::vector<Triangle> before = mesh.triangles;
  EXPECT_EQ(repair_mesh(mesh),
            std::vector<std::string>({"1 one-sided piece(s) cannot be oriented and stay as they are"}));
  EXPECT_EQ(mesh.triangles, before);
}

/// The corners of polygon p from its first one on, and those of the fan that its triangles make.
std::pair<std::vector<Index>, std::vector<Index>> polygon_and_fan(const SurfaceMesh& mesh, std::size_t p) {
  const auto corner = [&](Index c) { return mesh.polygons.corner_vertices[static_cast<std::size_t>(c)]; };
  std::vector<Index> polygon, fan;
  for (Index c = mesh.polygons.offsets[p]; c < mesh.polygons.offsets[p + 1]; ++c) polygon.push_back(corner(c));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.triangle_polygon[t] != static_cast<Index>(p)) continue;
    for (const Index v : mesh.triangles[t])
      if (std::find(fan.begin(), fan.end(), v) == fan.end()) fan.push_back(v);
  }
  return {polygon, fan};
}

TEST(RepairMesh, TurnsPolygonsWithTheirTriangles) {
  const SurfaceMesh sound = unit_box();
  SurfaceMesh inward = sound;
  inward.polygons.corner_textures = inward.polygons.corner_vertices;
  for (std::vector<Index>* corners : {&inward.polygons.corner_vertices, &inward.polygons.corner_textures})
    for (std::size_t p = 0; p < inward.polygons.size(); ++p)
      std::reverse(corners->begin() + inward.polygons.offsets[p], corners->begin() + inward.polygons.offsets[p + 1]);
  for (Triangle& triangle : inward.triangles) std::swap(triangle[1], triangle[2]);
  const SurfaceMesh given = inward;
  repair_mesh(inward);
  EXPECT_GT(volume(inward), 0);
  EXPECT_EQ(inward.polygons.corner_textures, inward.polygons.corner_vertices) << "each corner keeps its texture";
  for (std::size_t p = 0; p < inward.polygons.size(); ++p) {
    const auto first = static_cast<std::size_t>(inward.polygons.offsets[p]);
    EXPECT_EQ(inward.polygons.corner_vertices[first], given.polygons.corner_vertices[first]);
    // As in the sound box, from another corner on.
    auto [polygon, fan] = polygon_and_fan(inward, p);
    auto [expected, unused] = polygon_and_fan(sound, p);
    const auto start = std::find(expected.begin(), expected.end(), polygon.front());
    ASSERT_NE(start, expected.end());
    std::rotate(expected.begin(), start, expected.end());
    EXPECT_EQ(polygon, expected) << p;
  }
}

/// Each page is a piece of its own at one edge of them all.
TEST(RepairMesh, TakesABookOfAHundredThousandPages) {
  SurfaceMesh book;
  constexpr Index kPages = 100000;
  for (Index page = 0; page < kPages; ++page) {
    const double angle = 6.28 * page / kPages;
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(std::cos(angle), std::sin(angle), 0.5)})
      book.positions.push_back(corner);
    book.triangles.push_back({3 * page, 3 * page + 1, 3 * page + 2});
  }
  repair_mesh(book);
  EXPECT_EQ(book.triangles.size(), static_cast<std::size_t>(kPages));
}

/// The used triangle far away makes the reach of joining, a share of the size, longer than all the others together.
TEST(RepairMesh, JoinsRimsThoughAnotherTriangleIsFarAway) {
  SurfaceMesh soup;
  constexpr Index kSide = 200;
  const auto add = [&](const Vec3& p, double size) {
    const auto first = static_cast<Index>(soup.positions.size());
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(size, 0, 0), Vec3(0, size, 0)}) soup.positions.push_back(p + corner);
    soup.triangles.push_back({first, first + 1, first + 2});
  };
  for (Index i = 0; i < kSide; ++i)
    for (Index j = 0; j < kSide; ++j) add(Vec3(i, j, 0) * 0.01, 0.007);
  const auto near = static_cast<Index>(soup.positions.size());
  add(Vec3(1e-4, 0, 0), -0.007);  // its first corner is to join that of the first triangle
  add(Vec3(1e6, 0, 0), 1);
  repair_mesh(soup);
  ASSERT_EQ(soup.joined.size(), soup.positions.size());
  EXPECT_EQ(soup.joined[static_cast<std::size_t>(near)], 0);
  for (std::size_t v = 1; v < static_cast<std::size_t>(near); ++v)
    ASSERT_EQ(soup.joined[v], static_cast<Index>(v)) << "their distance is more than a quarter of their edges";
}

TEST(VertexNormals, AreOneAlongRimsThatRepairJoined) {
  SurfaceMesh roof;
  roof.positions = {{0, 1, 0}, {0, 1, 1}, {-1, 0, 0}, {1e-7, 1, 0}, {1e-7, 1, 1}, {1, 0, 0}};
  roof.triangles = {{0, 2, 1}, {3, 4, 5}};
  repair_mesh(roof);
  ASSERT_EQ(roof.joined, std::vector<Index>({0, 1, 2, 0, 1, 5}));
  const std::vector<Vec3> normals = vertex_normals(roof, roof.positions);
  EXPECT_EQ(normals[3], normals[0]);
  EXPECT_EQ(normals[4], normals[1]);
  EXPECT_LT((normals[0].cwiseAbs() - Vec3::UnitY()).norm(), 1e-6) << normals[0].transpose();
}

/// Closed pieces all over a ball: each is nested in one of many.
TEST(RepairMesh, TellsTheNestingOfAHundredThousandShells) {
  SurfaceMesh mesh = test::make_sphere(1000, 8, Vec3::Zero());
  const std::size_t ball = mesh.triangles.size();
  constexpr Index kSide = 46;
  for (Index k = 0; k < kSide * kSide * kSide; ++k) {
    const Vec3 p = 10 * Vec3(k % kSide - kSide / 2, k / kSide % kSide - kSide / 2, k / kSide / kSide - kSide / 2);
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      mesh.positions.push_back(p + corner);
    for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 3, 1}, Triangle{0, 2, 3}, Triangle{1, 3, 2}})
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const std::vector<Triangle> given = mesh.triangles;
  EXPECT_TRUE(repair_mesh(mesh).empty()) << "inward in a ball: bubbles";
  EXPECT_EQ(mesh.triangles, given);
  EXPECT_GT(mesh.triangles.size(), ball + 380000);
}

/// A unit ball of 4,800 triangles and small tetrahedra all over its box, each turned inward: bubbles in the ball, or
/// stray pieces beside it.
TEST(RepairMesh, KeepsBubblesInABallAndTurnsWhatLiesBesideIt) {
  SurfaceMesh mesh = test::make_sphere(1, 20, Vec3::Zero());
  const std::size_t ball = mesh.triangles.size();
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-0.95, 0.95);
  std::vector<bool> is_bubble;
  while (is_bubble.size() < 400) {
    const Vec3 p(place(random), place(random), place(random));
    if (std::abs(p.norm() - 1) < 0.1) continue;
    is_bubble.push_back(p.norm() < 1);
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      mesh.positions.push_back(p + 0.02 * corner);
    for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 3, 1}, Triangle{0, 2, 3}, Triangle{1, 3, 2}})
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  mesh.triangle_polygon.assign(mesh.triangles.size(), 0);
  const std::vector<Triangle> given = mesh.triangles;
  repair_mesh(mesh);
  ASSERT_EQ(mesh.triangles.size(), given.size());
  EXPECT_TRUE(std::equal(given.begin(), given.begin() + static_cast<std::ptrdiff_t>(ball), mesh.triangles.begin()));
  for (std::size_t piece = 0; piece < is_bubble.size(); ++piece)
    for (std::size_t t = ball + 4 * piece; t < ball + 4 * (piece + 1); ++t)
      EXPECT_EQ(mesh.triangles[t] == given[t], is_bubble[piece]) << piece;
}

}  // namespace
}  // namespace softreel
