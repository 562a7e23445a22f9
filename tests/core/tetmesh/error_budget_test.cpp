#include "core/tetmesh/graded/error_budget.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "core/tetmesh/graded/graded_stuffing.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_checks.h"
#include "tests/support/tiny_mesh_reader.h"

namespace softreel {
namespace {

/// Fills within `error`; collects what was said.
TetMesh fill(const SurfaceMesh& surface, double error, std::vector<std::string>& lines, int threads = 1) {
  const auto collect = [&](const std::string& line) { lines.push_back(line); };
  StageTimes times;
  return tetrahedralize(surface, {.error = error}, "blob", Threads(threads), {collect, collect}, times);
}

void expect_good_graded(const TetMesh& mesh) {
  const TetQuality quality = measure_quality(mesh, Threads(1));
  EXPECT_GT(quality.min_volume, 0);
  EXPECT_GE(quality.min_dihedral, kMinGradedDihedral);
  EXPECT_LE(quality.max_dihedral, kMaxGradedDihedral);
  test::expect_manifold_boundary(mesh);
}

/// A ball with a thin spike along x: the spike asks for smaller leaves than the ball.
SurfaceMesh spiked_ball() {
  SurfaceMesh mesh = test::make_sphere(1, 60, Vec3::Zero());
  for (Vec3& p : mesh.positions) {
    const double across = std::hypot(p.y(), p.z());
    if (p.x() > 0 && across < 0.12) p.x() += 12 * (0.12 - across);
  }
  return mesh;
}

/// A cone with its tip at (0, 1, 0) and its base, of radius 0.6, at y = -0.5.
SurfaceMesh cone() {
  return test::make_cube_sides(40, [](const Vec3& p) {
    const Vec3 d = p.normalized();
    const double side = std::hypot(d.x(), d.z()) + 0.4 * d.y();
    double reach = side > 0 ? 0.4 / side : 1e300;
    if (d.y() < 0) reach = std::min(reach, -0.5 / d.y());
    return Vec3(reach * d);
  });
}

SurfaceMesh overlapping_balls() {
  SurfaceMesh mesh = test::make_sphere(1, 30, Vec3::Zero());
  test::append(mesh, test::make_sphere(0.8, 30, Vec3(1.1, 0.1, 0.2)));
  return mesh;
}

/// Two balls and the thin rod between their centres, as three closed pieces.
SurfaceMesh dumbbell() {
  SurfaceMesh mesh = test::make_sphere(0.5, 20, Vec3(-1, 0, 0));
  test::append(mesh, test::make_sphere(0.5, 20, Vec3(1, 0, 0)));
  test::append(mesh, test::make_box({1, 0.04, 0.04}, 8, Vec3(0, 0.01, 0.02)));
  return mesh;
}

/// The mesh keeps to 0.6 % of the box's diagonal, is one piece of the right genus, and nothing had to be said of it.
void expect_kept_budget(const SurfaceMesh& surface, int euler) {
  std::vector<std::string> lines;
  const double error = 0.006 * used_bounds(surface).diagonal();
  const TetMesh mesh = fill(surface, error, lines);
  EXPECT_LE(measure_deviation(surface, mesh, Threads(1)).two_way(), error);
  expect_good_graded(mesh);
  EXPECT_EQ(test::euler_characteristic(mesh), euler);
  EXPECT_EQ(test::count_pieces(mesh), 1);
  EXPECT_TRUE(lines.empty()) << lines.front();
}

TEST(FillToError, KeepsToItsBudgetOnSmoothAndSharpSurfaces) {
  expect_kept_budget(test::make_sphere(1, 40, Vec3::Zero()), 2);
  expect_kept_budget(test::make_torus(1, 0.35, 64, 32, Vec3(0.1, 0.2, 0.3)), 0);
  expect_kept_budget(test::make_box({1, 0.6, 0.4}, 4, Vec3::Zero()), 2);
  expect_kept_budget(cone(), 2);
}

TEST(FillToError, KeepsToItsBudgetOnThinAndOverlappingSurfaces) {
  expect_kept_budget(spiked_ball(), 2);
  expect_kept_budget(overlapping_balls(), 2);
  expect_kept_budget(dumbbell(), 2);
}

TEST(FillToError, IsFineAtASpikeAndCoarseInside) {
  std::vector<std::string> lines;
  const SurfaceMesh surface = spiked_ball();
  const TetMesh mesh = fill(surface, 0.02, lines);
  double in_spike = 0, in_ball = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    const Vec3 center = (mesh.nodes[static_cast<std::size_t>(a)] + mesh.nodes[static_cast<std::size_t>(b)] +
                         mesh.nodes[static_cast<std::size_t>(c)] + mesh.nodes[static_cast<std::size_t>(d)]) /
                        4;
    const double volume = tet_volume(mesh.nodes[static_cast<std::size_t>(a)], mesh.nodes[static_cast<std::size_t>(b)],
                                     mesh.nodes[static_cast<std::size_t>(c)], mesh.nodes[static_cast<std::size_t>(d)]);
    if (center.x() > 1.5) in_spike = std::max(in_spike, volume);
    if (center.norm() < 0.4) in_ball = std::max(in_ball, volume);
  }
  EXPECT_GT(in_spike, 0);
  EXPECT_GT(in_ball, 8 * in_spike);
}

TEST(FillToError, SaysWhatItCannotReach) {
  // A blade as thin as a hundredth of the budget's finest edge.
  SurfaceMesh surface = test::make_sphere(1, 24, Vec3::Zero());
  test::append(surface, test::make_box({1e-5, 0.3, 0.3}, 8, Vec3(1.1, 0, 0)));
  std::vector<std::string> lines;
  try {
    const TetMesh mesh = fill(surface, 0.02, lines);
    ASSERT_FALSE(lines.empty());
    EXPECT_NE(lines.back().find("error = 0.03 m"), std::string::npos) << lines.back();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    EXPECT_NE(std::string(error.what()).find("part 2 of 2"), std::string::npos) << error.what();
  }
}

/// A rod of 10 by 0.02 by 0.02: a thousandth of the base edges' cells.
SurfaceMesh thin_rod() {
  return test::make_box({5, 0.01, 0.01}, 1, Vec3(5, 0.01, 0.01));
}

TEST(FillToError, KeepsARodThatIsMuchThinnerThanTheErrorInOnePiece) {
  std::vector<std::string> lines;
  const TetMesh mesh = fill(thin_rod(), 0.1, lines);
  EXPECT_EQ(test::count_pieces(mesh), 1);
  EXPECT_LE(measure_deviation(thin_rod(), mesh, Threads(1)).two_way(), 0.1);
  EXPECT_GT(measure_quality(mesh, Threads(1)).volume, 0.8 * 0.004);
  expect_good_graded(mesh);
}

TEST(FillToError, KeepsAThinLimbOnItsBody) {
  SurfaceMesh surface = test::make_sphere(1, 12, Vec3::Zero());
  test::append(surface, test::make_box({1.25, 0.01, 0.01}, 1, Vec3(1.75, 0, 0)));
  std::vector<std::string> lines;
  const TetMesh mesh = fill(surface, 0.05, lines);
  EXPECT_EQ(test::count_pieces(mesh), 1);
  EXPECT_LE(measure_deviation(surface, mesh, Threads(1)).two_way(), 0.05);
}

/// A cube with a rod of 3.5 m, 0.015 thick, and a second cube that touches the first at an edge: two pieces.
TEST(FillToError, KeepsAThinLimbBesideASolidThatTouchesItsBody) {
  SurfaceMesh surface = test::make_box({0.5, 0.5, 0.5}, 2, Vec3::Zero());
  test::append(surface, test::make_box({1.75, 0.0075, 0.0075}, 1, Vec3(2, 0.01, 0.02)));
  test::append(surface, test::make_box({0.5, 0.5, 0.5}, 2, Vec3(-1, 1, 0)));
  std::vector<std::string> lines;
  const TetMesh mesh = fill(surface, 0.1, lines);
  EXPECT_EQ(test::count_pieces(mesh), 2);
  EXPECT_LE(measure_deviation(surface, mesh, Threads(1)).two_way(), 0.1);
  EXPECT_LT(mesh.tets.size(), 100000u) << "the cubes are two by right, and want no finer edges";
  EXPECT_TRUE(lines.empty()) << lines.front();
}

/// A triangle that stands on an edge of a box: nothing is inside of it at any size.
TEST(FillToError, GivesUpOnAFinWithoutThicknessAndSaysWhere) {
  SurfaceMesh surface = test::make_box({0.5, 0.5, 0.5}, 3, Vec3::Zero());
  const auto tip = static_cast<Index>(surface.positions.size());
  surface.positions.emplace_back(1.5, 1.5, 1.5);
  const Triangle first = surface.triangles.front();
  surface.triangles.push_back({first[0], first[1], tip});
  std::vector<std::string> lines;
  const TetMesh mesh = fill(surface, 0.04, lines);
  EXPECT_EQ(test::count_pieces(mesh), 1);
  ASSERT_FALSE(lines.empty());
  EXPECT_NE(lines.back().find("part 1 of 1"), std::string::npos) << lines.back();
}

/// Fills with so many graded elements, or with graded ones from an edge.
TetMesh fill_graded(const SurfaceMesh& surface, double edge, std::int64_t tets, int threads = 1) {
  StageTimes times;
  const auto ignore = [](const std::string&) {};
  return tetrahedralize(surface, {.edge = edge, .tets = tets, .graded = true}, "blob", Threads(threads),
                        {ignore, ignore}, times);
}

/// The count is met, and the boundary is nearer to the surface than that of a lattice of as many elements.
void expect_nearer_than_a_lattice(const SurfaceMesh& surface) {
  for (const std::int64_t tets : {6000, 20000}) {
    const TetMesh graded = fill_graded(surface, 0, tets);
    EXPECT_NEAR(static_cast<double>(graded.tets.size()) / static_cast<double>(tets), 1.0, 0.05);
    expect_good_graded(graded);
    StageTimes times;
    const auto ignore = [](const std::string&) {};
    const TetMesh lattice = tetrahedralize(surface, {.tets = tets}, "blob", Threads(1), {ignore, ignore}, times);
    EXPECT_LT(measure_deviation(surface, graded, Threads(1)).two_way(),
              measure_deviation(surface, lattice, Threads(1)).two_way());
  }
}

TEST(FillToCount, MeetsItAndIsNearerToASpikeThanALattice) {
  expect_nearer_than_a_lattice(spiked_ball());
}

TEST(FillToCount, MeetsItAndIsNearerToAConeThanALattice) {
  expect_nearer_than_a_lattice(cone());
}

TEST(FillToCount, MeetsItAndIsNearerToADumbbellThanALattice) {
  expect_nearer_than_a_lattice(dumbbell());
}

/// So few tetrahedra cannot hold it together; what is left of it is no answer.
TEST(FillToCount, RefusesARodThatItsTetrahedraCannotHoldTogether) {
  try {
    const TetMesh mesh = fill_graded(thin_rod(), 0, 3000);
    ADD_FAILURE() << "filled with " << mesh.tets.size();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    for (const char* named : {"part 1 of 1", "too thin", "an edge of about"})
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
  }
}

/// A sliver in one piece, but its tips are missing: they are thinner than so many tetrahedra are.
TEST(FillToCount, RefusesWhatLeavesOutMuchOfASliver) {
  SurfaceMesh sliver;
  sliver.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.4, 1, 0), Vec3(0.5, 0.3, 0.03)};
  sliver.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (const std::int64_t tets : {100, 300, 1000}) try {
      const TetMesh mesh = fill_graded(sliver, 0, tets);
      EXPECT_EQ(test::count_pieces(mesh), 1);
      EXPECT_GT(measure_quality(mesh, Threads(1)).volume, 0.8 * 0.005) << tets;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("too thin"), std::string::npos) << error.what();
    }
}

TEST(FillToCount, GivesEqualBitsAtOneAndThreeThreads) {
  const TetMesh one = fill_graded(spiked_ball(), 0, 5000), three = fill_graded(spiked_ball(), 0, 5000, 3);
  EXPECT_EQ(one.nodes, three.nodes);
  EXPECT_EQ(one.tets, three.tets);
}

TEST(FillToCount, WithAnEdgeIsAsFineAtTheSurfaceAndHasFewerInside) {
  const SurfaceMesh surface = test::make_sphere(1, 40, Vec3::Zero());
  const TetMesh graded = fill_graded(surface, 0.1, 0);
  StageTimes times;
  const auto ignore = [](const std::string&) {};
  const TetMesh lattice = tetrahedralize(surface, {.edge = 0.1}, "blob", Threads(1), {ignore, ignore}, times);
  expect_good_graded(graded);
  EXPECT_LT(graded.tets.size(), 0.8 * static_cast<double>(lattice.tets.size()));
  EXPECT_LT(measure_deviation(surface, graded, Threads(1)).two_way(),
            1.5 * measure_deviation(surface, lattice, Threads(1)).two_way());
}

TEST(FillToError, DoesNotRefineTheCapsOfHoles) {
  // No size brings the cap of the hole, which is as wide as 0.9, nearer to the surface.
  SurfaceMesh surface = test::make_sphere(1, 24, Vec3::Zero());
  std::erase_if(surface.triangles, [&](const Triangle& triangle) {
    return std::ranges::all_of(triangle,
                               [&](Index v) { return surface.positions[static_cast<std::size_t>(v)][1] < -0.9; });
  });
  std::vector<std::string> lines;
  const TetMesh mesh = fill(surface, 0.02, lines);
  double near_volume = 0, near_count = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    const Vec3 &x = mesh.nodes[static_cast<std::size_t>(a)], &y = mesh.nodes[static_cast<std::size_t>(b)],
               &z = mesh.nodes[static_cast<std::size_t>(c)], &w = mesh.nodes[static_cast<std::size_t>(d)];
    if (((x + y + z + w) / 4 - Vec3(0, -0.9, 0)).norm() > 0.2) continue;
    near_volume += tet_volume(x, y, z, w);
    ++near_count;
  }
  ASSERT_GT(near_count, 0);
  // A lattice tetrahedron has a twelfth of the cube of its long edge. In flat places edges are 12 budgets long.
  EXPECT_GT(std::cbrt(12 * near_volume / near_count), 3 * 0.02);
}

TEST(MeasureDeviation, LeavesOutWhatOverlapsHide) {
  const SurfaceMesh balls = overlapping_balls();
  StageTimes times;
  const auto ignore = [](const std::string&) {};
  const TetMesh mesh = tetrahedralize(balls, {.edge = 0.12}, "blob", Threads(1), {ignore, ignore}, times);
  // The hidden caps lie as deep as 0.4; the crease round the balls is cut by less than an edge.
  EXPECT_LT(measure_deviation(balls, mesh, Threads(1)).two_way(), 0.12);
}

TEST(MeasureDeviation, CountsWhatIsMissing) {
  SurfaceMesh surface = test::make_sphere(1, 16, Vec3::Zero());
  StageTimes times;
  const auto ignore = [](const std::string&) {};
  const TetMesh mesh = tetrahedralize(surface, {.edge = 0.2}, "blob", Threads(1), {ignore, ignore}, times);
  test::append(surface, test::make_sphere(0.5, 12, Vec3(3, 0, 0)));
  EXPECT_NEAR(measure_deviation(surface, mesh, Threads(1)).two_way(), 2.5, 0.02);
}

TEST(FillToError, GivesEqualBitsAtOneAndFourThreads) {
  std::vector<std::string> lines;
  const SurfaceMesh surface = spiked_ball();
  const TetMesh one = fill(surface, 0.02, lines), four = fill(surface, 0.02, lines, 4);
  EXPECT_EQ(one.nodes, four.nodes);
  EXPECT_EQ(one.tets, four.tets);
}

TEST(FillToError, ReachesASharedMeshWithFewTetrahedra) {
  const std::string path = std::string(SOFTREEL_SOURCE_DIR) + "/../shared/meshes/spot.obj";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const SurfaceMesh surface = test::read_tiny_mesh(path);
  std::vector<std::string> lines;
  const double error = 0.003 * used_bounds(surface).diagonal();
  const TetMesh mesh = fill(surface, error, lines);
  EXPECT_LE(measure_deviation(surface, mesh, Threads(1)).two_way(), error);
  EXPECT_LT(mesh.tets.size(), 25000U);
  expect_good_graded(mesh);
}

}  // namespace
}  // namespace softreel
