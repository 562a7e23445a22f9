#include "core/tetmesh/filling/tetrahedralize.h"

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/tetmesh/filling/waiting_log.h"
#include "core/tetmesh/surface/surface_parts.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_checks.h"
#include "tests/support/tiny_mesh_reader.h"

namespace softreel {
namespace {

using test::count_pieces;
using test::euler_characteristic;
using test::expect_good_tets;
using test::expect_manifold_boundary;

/// Fills a surface; collects what was said.
struct Filling {
  explicit Filling(int threads = 1) : threads_(threads) {}
  TetMesh operator()(const SurfaceMesh& surface, const TetrahedralizeParams& params) {
    const auto collect = [this](const std::string& line) { lines.push_back(line); };
    return tetrahedralize(surface, params, "blob", threads_, {collect, collect}, times);
  }
  std::vector<std::string> lines;
  StageTimes times;

 private:
  Threads threads_;
};

class Tetrahedralize : public ::testing::Test {
 protected:
  Filling fill;
};

TEST_F(Tetrahedralize, FillsASphere) {
  const SurfaceMesh surface = test::make_sphere(1, 24, Vec3::Zero());
  const TetMesh mesh = fill(surface, {0.12, 0});
  expect_good_tets(mesh);
  expect_manifold_boundary(mesh);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_EQ(count_pieces(mesh), 1);
  EXPECT_NEAR(measure_quality(mesh, Threads(1)).volume, 4.0 / 3.0 * std::numbers::pi, 0.05);
  EXPECT_LT(measure_deviation(surface, mesh, Threads(1)).two_way(), 0.01);
  EXPECT_TRUE(fill.times.entries().contains("tetrahedralize/distance"));
}

TEST_F(Tetrahedralize, FillsATorusThatStaysATorus) {
  const TetMesh mesh = fill(test::make_torus(1, 0.35, 48, 24, Vec3::Zero()), {0.15, 0});
  expect_good_tets(mesh);
  expect_manifold_boundary(mesh);
  EXPECT_EQ(euler_characteristic(mesh), 0);
}

TEST_F(Tetrahedralize, FillsAThinSlab) {
  const TetMesh mesh = fill(test::make_box({1, 1, 0.04}, 2, Vec3(0.3, 0.2, 0.1)), {0.1, 0});
  expect_good_tets(mesh);
  expect_manifold_boundary(mesh);
  EXPECT_EQ(count_pieces(mesh), 1);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_NEAR(measure_quality(mesh, Threads(1)).volume, 0.32, 0.03);
}

TEST_F(Tetrahedralize, FillsTwoPiecesAsTwo) {
  SurfaceMesh surface = test::make_sphere(1, 12, Vec3::Zero());
  test::append(surface, test::make_sphere(0.5, 12, Vec3(2, 0, 0)));
  const TetMesh mesh = fill(surface, {0.2, 0});
  EXPECT_EQ(count_pieces(mesh), 2);
  EXPECT_EQ(euler_characteristic(mesh), 4);
}

TEST_F(Tetrahedralize, KeepsACavity) {
  SurfaceMesh surface = test::make_sphere(1, 12, Vec3::Zero()), hole = test::make_sphere(0.5, 12, Vec3::Zero());
  test::turn_inside_out(hole);
  test::append(surface, hole);
  const TetMesh mesh = fill(surface, {0.15, 0});
  EXPECT_EQ(euler_characteristic(mesh), 4);
  EXPECT_NEAR(measure_quality(mesh, Threads(1)).volume, 4.0 / 3.0 * std::numbers::pi * 0.875, 0.1);
}

TEST_F(Tetrahedralize, GivesTheSameFarFromTheOrigin) {
  const TetMesh near = fill(test::make_torus(1, 0.35, 32, 16, Vec3::Zero()), {0.15, 0});
  const TetMesh far = fill(test::make_torus(1, 0.35, 32, 16, Vec3(4e5, -7e5, 1e5)), {0.15, 0});
  expect_good_tets(far);
  expect_manifold_boundary(far);
  EXPECT_NEAR(static_cast<double>(far.tets.size()), static_cast<double>(near.tets.size()), 200);
  EXPECT_NEAR(measure_quality(far, Threads(1)).volume, measure_quality(near, Threads(1)).volume, 1e-3);
}

TEST_F(Tetrahedralize, FillsASurfaceTurnedInsideOut) {
  SurfaceMesh surface = test::make_sphere(1, 12, Vec3::Zero());
  const TetMesh expected = fill(surface, {0.2, 0});
  test::turn_inside_out(surface);
  EXPECT_EQ(fill(surface, {0.2, 0}).tets, expected.tets);
}

TEST_F(Tetrahedralize, FillsAnOpenSurface) {
  SurfaceMesh surface = test::make_sphere(1, 16, Vec3::Zero());
  std::erase_if(surface.triangles, [&](const Triangle& triangle) {
    return std::ranges::all_of(triangle,
                               [&](Index v) { return surface.positions[static_cast<std::size_t>(v)][1] < -0.9; });
  });
  const TetMesh mesh = fill(surface, {0.15, 0});
  expect_good_tets(mesh);
  expect_manifold_boundary(mesh);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_NEAR(measure_quality(mesh, Threads(1)).volume, 4.0 / 3.0 * std::numbers::pi, 0.15);
}

TEST_F(Tetrahedralize, IgnoresAFarUnusedVertex) {
  SurfaceMesh surface = test::make_sphere(1, 12, Vec3::Zero());
  const TetMesh expected = fill(surface, {0.2, 0});
  surface.positions.emplace_back(1e7, 0, 0);
  EXPECT_EQ(fill(surface, {0.2, 0}).nodes, expected.nodes);
}

/// A closed needle of a length that its quarters would be counted by the square of.
TEST_F(Tetrahedralize, FillsABodyBesideALongNeedle) {
  SurfaceMesh surface = test::make_sphere(1, 12, Vec3::Zero());
  const auto first = static_cast<Index>(surface.positions.size());
  for (const Vec3& corner : {Vec3(0, 3, 0), Vec3(500, 3, 0), Vec3(0, 3.01, 0), Vec3(0, 3, 0.01)})
    surface.positions.push_back(corner);
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{1, 2, 3}})
    surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  const TetMesh mesh = fill(surface, {.edge = 0.25, .mode = TetMode::Embedded});
  EXPECT_EQ(count_pieces(mesh), 2);
}

TEST_F(Tetrahedralize, SaysOfAFilmThatAllOfItIsFlat) {
  const SurfaceMesh film = test::make_box(Vec3(0.5, 0.5, 2e-7), 4, Vec3::Zero());
  for (const TetrahedralizeParams& params : {TetrahedralizeParams{.tets = 20000},
                                             {.edge = 0.1},
                                             {.edge = 0.1, .graded = true},
                                             {.tets = 5000, .graded = true}})
    try {
      fill(film, params);
      ADD_FAILURE() << "filled";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("all of its surface is flat"), std::string::npos) << error.what();
    }
}

TEST_F(Tetrahedralize, NamesTheEdgeThatWasGivenWhereAGradedPartIsTooThin) {
  SurfaceMesh both = test::make_sphere(0.5, 16, Vec3::Zero());
  test::append(both, test::make_box(Vec3(0.5, 0.5, 5e-4), 4, Vec3(3, 0, 0)));
  try {
    fill(both, {.edge = 0.05, .graded = true});
    ADD_FAILURE() << "filled";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("0.05 m"), std::string::npos) << error.what();
  }
}

/// Six squares, each a little larger than the side of the box that they make: open parts that are flat each by itself.
TEST_F(Tetrahedralize, FillsABoxOfSeparatePanels) {
  SurfaceMesh panels;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto first = static_cast<Index>(panels.positions.size());
      for (const auto& [u, v] : {std::pair(-1.1, -1.1), {1.1, -1.1}, {1.1, 1.1}, {-1.1, 1.1}}) {
        Vec3 p = side * Vec3::Unit(axis);
        p[(axis + 1) % 3] = side * u;
        p[(axis + 2) % 3] = v;
        panels.positions.push_back(p);
      }
      panels.triangles.insert(panels.triangles.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
    }
  const TetMesh mesh = fill(panels, {.edge = 0.2});
  EXPECT_NEAR(measure_quality(mesh, Threads(1)).volume, 8, 0.8);
}

TEST(WaitingLog, PassesItsLinesOnWhereFillingThrows) {
  std::vector<std::string> said;
  const auto collect = [&](const std::string& line) { said.push_back(line); };
  WaitingLog lines;
  const auto refuse = [&] {
    lines.sink().warn("thickened");
    throw input_error("too thin");
  };
  EXPECT_THROW(lines.fill_or_pass_on({collect, collect}, refuse), Error);
  EXPECT_EQ(said, std::vector<std::string>{"thickened"});
  said.clear();
  EXPECT_EQ(lines.fill_or_pass_on({collect, collect}, [] { return 1; }), 1);
  EXPECT_TRUE(said.empty()) << "a mesh that is only tried";
}

/// The volume of an open part is about the middle of the open ones, and a small closed part's is no round-off of a
/// place far away.
TEST(FindParts, MeasuresClosedPartsAboutTheirOwnMiddle) {
  SurfaceMesh bucket = test::make_box(Vec3::Constant(0.5), 4, Vec3::Zero());
  std::erase_if(bucket.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(),
                       [&](Index v) { return bucket.positions[static_cast<std::size_t>(v)].y() > 0.49; });
  });
  const double alone = find_parts(bucket).parts.front().volume;
  SurfaceMesh both = bucket;
  test::append(both, test::make_box(Vec3::Constant(0.005), 2, Vec3(1000, 0, 0)));
  const SurfaceParts parts = find_parts(both);
  ASSERT_EQ(parts.parts.size(), 2U);
  EXPECT_NEAR(parts.parts[0].volume, alone, 1e-9);
  EXPECT_NEAR(parts.parts[1].volume, 1e-6, 1e-12);
}

/// About half an edge wide: the lattice about the body's centre has no tetrahedron in it, others do.
TEST_F(Tetrahedralize, FillsASmallPartThatAnotherLatticeMeets) {
  SurfaceMesh both = test::make_sphere(1, 16, Vec3::Zero());
  test::append(both, test::make_sphere(0.18, 6, Vec3(3, 0, 0)));
  const TetMesh mesh = fill(both, {.tets = 2000});
  EXPECT_EQ(count_pieces(mesh), 2);
  EXPECT_NEAR(static_cast<double>(mesh.tets.size()), 2000, 100);
}

TEST_F(Tetrahedralize, MeetsTheWantedCount) {
  for (const std::int64_t wanted : {2000, 9000, 30000}) {
    const TetMesh mesh = fill(test::make_torus(1, 0.35, 48, 24, Vec3::Zero()), {0, wanted});
    EXPECT_NEAR(static_cast<double>(mesh.tets.size()) / static_cast<double>(wanted), 1.0, 0.05);
  }
}

/// As thin as the lattice's edge: the count goes in jumps from lattice to lattice.
TEST_F(Tetrahedralize, MeetsTheWantedCountOfASheet) {
  const SurfaceMesh sheet = test::make_box(Vec3(0.5, 0.025, 0.5), 10, Vec3::Zero());
  for (const std::int64_t wanted : {3000, 4000, 5000}) {
    const TetMesh mesh = fill(sheet, {0, wanted});
    EXPECT_NEAR(static_cast<double>(mesh.tets.size()) / static_cast<double>(wanted), 1.0, 0.05);
  }
}

TEST_F(Tetrahedralize, GivesEqualBitsAtOneAndFourThreads) {
  const SurfaceMesh surface = test::make_torus(1, 0.35, 96, 48, Vec3(0.1, 0.2, 0.3));
  Filling four(4);
  const TetMesh a = fill(surface, {0.08, 0}), b = four(surface, {0.08, 0});
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.tets, b.tets);
}

TEST_F(Tetrahedralize, NamesAPartThatIsTooThinAndTheEdgeItNeeds) {
  SurfaceMesh surface = test::make_sphere(1, 12, Vec3::Zero());
  test::append(surface, test::make_sphere(0.02, 6, Vec3(2.03, 0.07, 0.04)));
  try {
    fill(surface, {0.25, 0});
    FAIL() << "the small sphere vanished without a word";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    for (const char* part : {"'blob'", "part 2 of 2", "0.25 m", "Accepted", "smaller edge"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST_F(Tetrahedralize, RefusesWrongSizesAndEmptySurfaces) {
  const SurfaceMesh surface = test::make_sphere(1, 4, Vec3::Zero());
  EXPECT_THROW(fill(surface, {0, 0}), Error);
  EXPECT_THROW(fill(surface, {0.1, 100}), Error);
  EXPECT_THROW(fill(surface, {1e-9, 0}), Error);
  EXPECT_THROW(fill(SurfaceMesh{}, {0.1, 0}), Error);
}

TEST_F(Tetrahedralize, FillsTheSharedMeshes) {
  const std::string folder = std::string(SOFTREEL_SOURCE_DIR) + "/../shared/meshes/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  for (const char* name : {"bunny.off", "spot.obj", "suzanne.obj", "cheburashka.obj"}) {
    SCOPED_TRACE(name);
    const SurfaceMesh surface = test::read_tiny_mesh(folder + name);
    const TetMesh mesh = fill(surface, {0, 20000});
    EXPECT_NEAR(static_cast<double>(mesh.tets.size()), 20000, 1000);
    expect_good_tets(mesh);
    expect_manifold_boundary(mesh);
  }
}

}  // namespace
}  // namespace softreel
