// Embedded mode: what is joined stays joined, what is parted stays parted, and volumes are the solid's.
#include "core/tetmesh/cells/embedded_lattice.h"

#include <filesystem>
#include <numbers>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/mesh/mesh_repair.h"
#include "core/skinning/embedding.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/broken_surfaces.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_checks.h"
#include "tests/support/thin_surfaces.h"
#include "tests/support/tiny_mesh_reader.h"

namespace softreel {
namespace {

TetMesh embed(const SurfaceMesh& surface, const TetrahedralizeParams& size, int threads = 1) {
  TetrahedralizeParams params = size;
  params.mode = TetMode::Embedded;
  StageTimes times;
  return tetrahedralize(surface, params, "blob", Threads(threads), {}, times);
}

double filled_volume(const TetMesh& mesh) {
  return measure_quality(mesh, Threads(1)).volume;
}

std::set<Index> carrying_nodes(const TetMesh& mesh, Index vertex) {
  const Tet& tet = mesh.tets[static_cast<std::size_t>(mesh.carriers[static_cast<std::size_t>(vertex)])];
  return {tet.begin(), tet.end()};
}

/// Piece of the element that carries each vertex.
std::vector<Index> vertex_pieces(const TetMesh& mesh) {
  const std::vector<Index> piece = face_connected_pieces(mesh);
  std::vector<Index> result;
  for (const Index element : mesh.carriers)
    result.push_back(element < 0 ? -1 : piece[static_cast<std::size_t>(element)]);
  return result;
}

void expect_vertices_inside(const SurfaceMesh& surface, const TetMesh& mesh) {
  std::vector<bool> used(surface.positions.size(), false);
  for (const Triangle& triangle : surface.triangles)
    for (const Index v : triangle) used[static_cast<std::size_t>(v)] = true;
  const std::vector<Vec3> normals(surface.positions.size(), Vec3(0, 1, 0));
  const Embedding embedding = embed_points(surface.positions, normals, mesh, Threads(1));
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v] || !surface.positions[v].allFinite()) continue;
    ASSERT_GE(mesh.carriers[v], 0) << "vertex " << v;
    ASSERT_EQ(embedding.elements[v], mesh.carriers[v]);
    for (const double weight : embedding.weights[v]) ASSERT_GE(weight, -1e-8) << "vertex " << v;
  }
}

void expect_lattice_tets(const TetMesh& mesh) {
  const TetQuality quality = measure_quality(mesh, Threads(1));
  EXPECT_GT(quality.min_volume, 0);
  EXPECT_NEAR(quality.min_dihedral, 60, 1e-3);
  EXPECT_NEAR(quality.max_dihedral, 90, 1e-3);
  for (const double fill : mesh.fill) {
    ASSERT_GE(fill, kLeastFill);
    ASSERT_LE(fill, 1);
  }
}

TEST(EmbeddedLattice, FillsWithExactlyTheVolumeOfAClosedSurface) {
  const SurfaceMesh ball = test::make_sphere(1, 16, Vec3(0.3, 0.1, -0.2));
  const double volume = find_parts(ball).volume();
  for (const double edge : {0.7, 0.35, 0.17}) {
    const TetMesh mesh = embed(ball, {.edge = edge});
    EXPECT_NEAR(filled_volume(mesh) / volume, 1, 1e-6) << edge;  // the least fills are above what they should be
    expect_lattice_tets(mesh);
    test::expect_manifold_boundary(mesh);
    expect_vertices_inside(ball, mesh);
    EXPECT_EQ(test::count_pieces(mesh), 1);
    EXPECT_EQ(test::euler_characteristic(mesh), 2);
  }
}

TEST(EmbeddedLattice, FillsOfAnOpenSurfaceComeNearTheVolumeAsTheLatticeGetsFiner) {
  SurfaceMesh bowl = test::make_sphere(1, 16, Vec3::Zero());
  std::erase_if(bowl.triangles,
                [&](const Triangle& t) { return bowl.positions[static_cast<std::size_t>(t[0])].y() > 0.6; });
  SurfaceMesh torn = test::make_sphere(1, 16, Vec3::Zero());
  const double volume = find_parts(torn).volume();
  torn.triangles.erase(torn.triangles.begin() + 200);
  for (const double edge : {0.4, 0.2})
    EXPECT_NEAR(filled_volume(embed(torn, {.edge = edge})) / volume, 1, 0.01) << edge;
  const double coarse = filled_volume(embed(bowl, {.edge = 0.4})), fine = filled_volume(embed(bowl, {.edge = 0.1}));
  EXPECT_NEAR(coarse / fine, 1, 0.02);
}

TEST(EmbeddedLattice, FillsOfABoxInTheLatticesOwnPlanesAreExact) {
  const SurfaceMesh box = test::make_box({1, 0.5, 0.5}, 4, Vec3::Zero());
  std::vector<CarriedPoint> points;
  const EmbeddedLattice cover = cover_with_lattice(box, find_parts(box), {Vec3::Zero(), 0.25}, points, Threads(1));
  EXPECT_NEAR(filled_volume(cover.mesh), 2, 1e-4);  // elements that only touch the box have the least fill
}

TEST(EmbeddedLattice, KeepsFingersOfOneCellApart) {
  SurfaceMesh fingers = test::make_box({1, 0.02, 0.02}, 2, Vec3(0, 0.025, 0));
  const auto first = static_cast<Index>(fingers.positions.size());
  test::append(fingers, test::make_box({1, 0.02, 0.02}, 2, Vec3(0, -0.025, 0)));
  const TetMesh mesh = embed(fingers, {.edge = 0.2});
  EXPECT_EQ(test::count_pieces(mesh), 2);
  expect_vertices_inside(fingers, mesh);
  test::expect_manifold_boundary(mesh);
  const std::vector<Index> pieces = vertex_pieces(mesh);
  for (std::size_t v = 0; v < pieces.size(); ++v)
    EXPECT_EQ(pieces[v], static_cast<Index>(v) < first ? pieces[0] : 1 - pieces[0]);
  EXPECT_NEAR(filled_volume(mesh), 2 * 2 * 0.04 * 0.04, 1e-8);
}

/// Thousands of stones in a few cells: all pairs of their triangles or of their copies would take minutes.
TEST(EmbeddedLattice, KeepsGravelOfFewCellsApart) {
  constexpr Index kSide = 16;
  SurfaceMesh gravel;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shift(-0.2, 0.2);
  std::vector<CarriedPoint> points;
  for (Index k = 0; k < kSide * kSide * kSide; ++k) {
    const Vec3 shifts(shift(random), shift(random), shift(random));
    const Vec3 place = (Vec3(k % kSide, k / kSide % kSide, k / kSide / kSide) + shifts) / kSide;
    const auto first = static_cast<Index>(gravel.positions.size());
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
      gravel.positions.push_back(place + 0.4 / kSide * corner);
      // Carried by number or found by place, it is in its own stone.
      points.push_back({gravel.positions.back(), k % 2 == 0 ? static_cast<Index>(gravel.positions.size()) - 1 : -1});
    }
    for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{1, 2, 3}})
      gravel.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const LatticeFrame frame{Vec3(0.013, 0.017, 0.011), 1.2};
  const EmbeddedLattice cover = cover_with_lattice(gravel, find_parts(gravel), frame, points, Threads(1));
  EXPECT_LT(cover.cut_cells, 50);
  EXPECT_EQ(test::count_pieces(cover.mesh), kSide * kSide * kSide);
  const std::vector<Index> pieces = vertex_pieces(cover.mesh);
  for (std::size_t v = 0; v < pieces.size(); ++v) ASSERT_EQ(pieces[v], pieces[v / 4 * 4]) << v;
}

TEST(EmbeddedLattice, JoinsFingersOnlyWhereTheyAreJoined) {
  const SurfaceMesh fork = test::make_fork(3, 0.05, 0.01);
  const TetMesh mesh = embed(fork, {.edge = 0.2});
  EXPECT_EQ(test::count_pieces(mesh), 1);
  expect_vertices_inside(fork, mesh);
  EXPECT_NEAR(filled_volume(mesh), 0.2 * (0.11 + 2 * 3 * 0.05), 1e-6);
  for (const Index v : {2, 3}) {  // the tip of one finger, and that of the other
    const std::set<Index> one = carrying_nodes(mesh, v), other = carrying_nodes(mesh, v == 2 ? 7 : 6);
    std::vector<Index> shared;
    std::set_intersection(one.begin(), one.end(), other.begin(), other.end(), std::back_inserter(shared));
    EXPECT_TRUE(shared.empty());
  }
}

TEST(EmbeddedLattice, HoldsTwoBallsTogetherByARodOfAFiftiethOfAnEdge) {
  for (const double edge : {0.5, 0.25}) {
    const SurfaceMesh dumbbell = test::make_dumbbell(0.01 * edge);
    const TetMesh mesh = embed(dumbbell, {.edge = edge});
    EXPECT_EQ(test::count_pieces(mesh), 1) << edge;
    test::expect_manifold_boundary(mesh);
    expect_vertices_inside(dumbbell, mesh);
    EXPECT_NEAR(filled_volume(mesh) / find_parts(dumbbell).volume(), 1, 1e-6);
  }
}

TEST(EmbeddedLattice, MovesBothSidesOfAThinPlateTogether) {
  const SurfaceMesh plate = test::make_box({1, 1, 1e-3}, 2, Vec3::Zero());
  const TetMesh mesh = embed(plate, {.edge = 0.1});
  EXPECT_EQ(describe_embedded(mesh).copies, 0);
  EXPECT_EQ(test::count_pieces(mesh), 1);
  EXPECT_NEAR(filled_volume(mesh), 8e-3, 1e-8);
}

TEST(EmbeddedLattice, HoldsAThinShellTogether) {
  SurfaceMesh shell = test::make_sphere(1, 16, Vec3::Zero()), hollow = test::make_sphere(0.99, 16, Vec3::Zero());
  test::turn_inside_out(hollow);
  test::append(shell, hollow);
  const TetMesh mesh = embed(shell, {.edge = 0.2});
  EXPECT_EQ(test::count_pieces(mesh), 1);
  EXPECT_NEAR(filled_volume(mesh) / find_parts(shell).volume(), 1, 1e-4);
}

TEST(EmbeddedLattice, KeepsBodiesThatTouchWithoutBeingJoinedApart) {
  SurfaceMesh blocks = test::make_box({0.5, 0.5, 0.5}, 3, Vec3::Zero());
  test::append(blocks, test::make_box({0.5, 0.5, 0.5}, 3, Vec3(1, 0, 0)));
  const TetMesh mesh = embed(blocks, {.edge = 0.2});
  EXPECT_EQ(test::count_pieces(mesh), 2);
  EXPECT_NEAR(filled_volume(mesh), 2, 1e-4);
  expect_vertices_inside(blocks, mesh);
}

TEST(EmbeddedLattice, IsTheSameForASurfaceTurnedInsideOut) {
  SurfaceMesh ball = test::make_sphere(1, 12, Vec3::Zero());
  const TetMesh expected = embed(ball, {.edge = 0.2});
  test::turn_inside_out(ball);
  const TetMesh mesh = embed(ball, {.edge = 0.2});
  EXPECT_EQ(mesh.tets, expected.tets);
  EXPECT_NEAR(filled_volume(mesh), filled_volume(expected), 1e-9);
}

TEST(EmbeddedLattice, MeetsTheWantedCount) {
  for (const std::int64_t wanted : {2000, 20000}) {
    const TetMesh mesh = embed(test::make_torus(1, 0.35, 48, 24, Vec3::Zero()), {.tets = wanted});
    EXPECT_NEAR(static_cast<double>(mesh.tets.size()) / static_cast<double>(wanted), 1.0, 0.05);
  }
}

TEST(EmbeddedLattice, GivesEqualBitsAtOneAndThreeThreads) {
  SurfaceMesh balls = test::make_sphere(1, 16, Vec3::Zero());
  test::append(balls, test::make_sphere(1, 16, Vec3(0.9, 0.1, 0)));
  const TetMesh one = embed(balls, {.edge = 0.15}), three = embed(balls, {.edge = 0.15}, 3);
  EXPECT_EQ(one.nodes, three.nodes);
  EXPECT_EQ(one.tets, three.tets);
  EXPECT_EQ(one.fill, three.fill);
  EXPECT_EQ(one.carriers, three.carriers);
}

TEST(EmbeddedLattice, RefusesAnErrorBudget) {
  try {
    embed(test::make_sphere(1, 6, Vec3::Zero()), {.error = 0.01});
    FAIL() << "was filled";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    for (const char* part : {"'blob'", "0.01", "embedded", "Accepted", "tets"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

class EmbeddedZoo : public ::testing::TestWithParam<test::BrokenSurface> {};

/// What differs from conforming mode: bodies that touch stay parted, and nothing is too thin.
Index expected_pieces(const test::BrokenSurface& broken) {
  const std::set<std::string> parted{"SharedEdge", "SharedCorner", "TinyPart", "HourglassOfOneWaistVertex"};
  return parted.contains(broken.name) ? 2 : std::max<Index>(broken.pieces, 1);
}

bool is_too_thin(const test::BrokenSurface& broken) {
  return broken.name == "TinyPart" || broken.refusal.find("too thin") != std::string::npos ||
         broken.refusal.find("an edge of about") != std::string::npos;
}

TEST_P(EmbeddedZoo, IsCoveredOrRefused) {
  const test::BrokenSurface& broken = GetParam();
  SurfaceMesh surface = broken.mesh();
  repair_mesh(surface);
  const TetrahedralizeParams params{.edge = broken.edge, .thickness = broken.thickness};
  const bool thin_only = is_too_thin(broken);
  if (!broken.refusal.empty() && !thin_only) {
    EXPECT_THROW(embed(surface, params), Error);
    return;
  }
  const TetMesh mesh = embed(surface, params);
  expect_lattice_tets(mesh);
  test::expect_manifold_boundary(mesh);
  EXPECT_EQ(test::count_pieces(mesh), expected_pieces(broken));
  const double volume = thin_only                ? find_parts(surface).volume()
                        : broken.thin_volume > 0 ? broken.thin_volume
                                                 : broken.volume;
  EXPECT_NEAR(filled_volume(mesh) / volume, 1, thin_only ? 1e-3 : broken.tolerance);
  if (surface.joined.empty()) expect_vertices_inside(surface, mesh);
  const TetMesh again = embed(surface, params, 3);
  EXPECT_EQ(again.nodes, mesh.nodes);
  EXPECT_EQ(again.fill, mesh.fill);
}

INSTANTIATE_TEST_SUITE_P(Zoo, EmbeddedZoo, ::testing::ValuesIn(test::broken_surfaces()),
                         [](const auto& surface) { return surface.param.name; });

TEST(EmbeddedLattice, CoversTheSharedMeshesInOnePiece) {
  const std::string folder = std::string(SOFTREEL_SOURCE_DIR) + "/../shared/meshes/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  for (const char* name : {"bunny.off", "spot.obj", "suzanne.obj", "cheburashka.obj"}) {
    SCOPED_TRACE(name);
    const SurfaceMesh surface = test::read_tiny_mesh(folder + name);
    for (const double share : {0.12, 0.03}) {
      const TetMesh mesh = embed(surface, {.edge = share * used_bounds(surface).diagonal()});
      expect_lattice_tets(mesh);
      expect_vertices_inside(surface, mesh);
      EXPECT_EQ(test::count_pieces(mesh), 1);
    }
  }
}

}  // namespace
}  // namespace softreel
