#include "core/tetmesh/improvement/angle_improvement.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/mesh/mesh_repair.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/bcc_bar.h"
#include "tests/support/broken_surfaces.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_checks.h"

namespace softreel {
namespace {

TetMesh fill(const SurfaceMesh& surface, const TetrahedralizeParams& params, int threads = 1) {
  StageTimes times;
  return tetrahedralize(surface, params, "blob", Threads(threads), {}, times);
}

/// The boundary faces, each from its smallest node on, sorted.
std::vector<Triangle> face_set(const TetMesh& mesh) {
  std::vector<Triangle> faces = boundary_faces(mesh);
  for (Triangle& face : faces) std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  std::sort(faces.begin(), faces.end());
  return faces;
}

std::vector<bool> boundary_nodes(const TetMesh& mesh) {
  std::vector<bool> on_boundary(mesh.nodes.size(), false);
  for (const Triangle& face : boundary_faces(mesh))
    for (const Index node : face) on_boundary[at(node)] = true;
  return on_boundary;
}

/// What holds for every mesh, however bad.
void expect_no_harm(const TetMesh& before, const TetMesh& after) {
  const Threads threads(1);
  const TetQuality was = measure_quality(before, threads), is = measure_quality(after, threads);
  EXPECT_GT(is.min_volume, 0);
  EXPECT_GE(is.min_dihedral, was.min_dihedral);
  EXPECT_LE(is.max_dihedral, was.max_dihedral);
  EXPECT_EQ(face_set(after), face_set(before));
  EXPECT_EQ(after.nodes.size(), before.nodes.size());
  EXPECT_EQ(test::count_pieces(after), test::count_pieces(before));
}

double two_way(const SurfaceMesh& surface, const TetMesh& mesh) {
  return measure_deviation(surface, mesh, Threads(1)).two_way();
}

/// A box of cubes cut in six, whose inner nodes were moved at random while no element shrank below a share of its
/// volume: slivers of all kinds.
TetMesh shaken_box(double reach, double least, unsigned seed) {
  TetMesh mesh = testing::kuhn_bar({6, 6, 6}, Vec3(1, 1, 1));
  mesh.lattice = {};
  const std::vector<bool> on_boundary = boundary_nodes(mesh);
  const double limit = least / (6.0 * 216.0);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(-reach, reach);
  for (int round = 0; round < 3; ++round)
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      const Vec3 old = mesh.nodes[i], move(step(random), step(random), step(random));
      if (on_boundary[i]) continue;
      mesh.nodes[i] += move;
      for (const auto& [a, b, c, d] : mesh.tets)
        if ((a == Index(i) || b == Index(i) || c == Index(i) || d == Index(i)) &&
            tet_volume(mesh.nodes[at(a)], mesh.nodes[at(b)], mesh.nodes[at(c)], mesh.nodes[at(d)]) < limit)
          mesh.nodes[i] = old;
    }
  return mesh;
}

struct Shape {
  const char* name;
  SurfaceMesh surface;
  TetrahedralizeParams params;
};

/// Turned out of the lattice's axes.
SurfaceMesh turned_box(const Vec3& half_size) {
  SurfaceMesh surface = test::make_box(half_size, 1, Vec3::Zero());
  const Quaternion turn(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()));
  for (Vec3& p : surface.positions) p = turn * p;
  return surface;
}

/// Each has elements that are worse than the target.
std::vector<Shape> shapes() {
  return {{"sphere", test::make_sphere(1, 40, Vec3::Zero()), {.edge = 0.12}},
          {"torus", test::make_torus(1, 0.35, 64, 32, Vec3(0.1, 0.2, 0.3)), {.edge = 0.13}},
          {"box of few triangles", turned_box({1, 0.7, 0.5}), {.edge = 0.16}},
          {"thin sheet", turned_box({1, 1, 0.05}), {.edge = 0.1}},
          {"graded torus", test::make_torus(1, 0.35, 64, 32, Vec3::Zero()), {.error = 0.012}}};
}

TEST(ImproveAngles, MakesStuffedMeshesBetterAndKeepsThemAtTheSurface) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const TetMesh before = fill(shape.surface, shape.params);
    TetMesh after = before;
    const AngleImprovement done = improve_angles(after, &shape.surface, {}, Threads(1));
    expect_no_harm(before, after);
    test::expect_manifold_boundary(after);
    EXPECT_EQ(after.lattice.spacing, before.lattice.spacing);
    EXPECT_LT(done.before.min_dihedral, 25);
    EXPECT_GT(done.after.min_dihedral, done.before.min_dihedral);
    EXPECT_GE(done.after.first_percentile_dihedral, done.before.first_percentile_dihedral);
    EXPECT_LT(done.after.max_dihedral, std::max(140.001, done.before.max_dihedral));
    EXPECT_LE(two_way(shape.surface, after), 1.002 * two_way(shape.surface, before));
    EXPECT_NEAR(done.after.volume, done.before.volume, 1e-2 * done.before.volume);
  }
}

TEST(ImproveAngles, BringsASmoothBodyToTheTarget) {
  const SurfaceMesh surface = test::make_sphere(1, 60, Vec3::Zero());
  TetMesh mesh = fill(surface, {.edge = 0.12});
  const AngleImprovement done = improve_angles(mesh, &surface, {}, Threads(1));
  EXPECT_LT(done.before.min_dihedral, 23);
  EXPECT_GE(done.after.min_dihedral, 24);
  EXPECT_LE(done.after.max_dihedral, 142);
}

TEST(ImproveAngles, KeepsTheBoundaryBitForBitWithoutASurface) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const TetMesh before = fill(shape.surface, shape.params);
    TetMesh after = before;
    const AngleImprovement done = improve_angles(after, nullptr, {}, Threads(1));
    expect_no_harm(before, after);
    EXPECT_EQ(done.slid_nodes, 0);
    EXPECT_NEAR(done.after.volume, done.before.volume, 1e-12 * done.before.volume);
    const std::vector<bool> on_boundary = boundary_nodes(before);
    for (std::size_t i = 0; i < before.nodes.size(); ++i)
      if (on_boundary[i]) {
        ASSERT_EQ(after.nodes[i], before.nodes[i]);
      }
  }
}

TEST(ImproveAngles, MendsTheSliversOfAShakenMesh) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const TetMesh before = shaken_box(0.12, 0.01, seed);
    TetMesh after = before;
    const AngleImprovement done = improve_angles(after, nullptr, {}, Threads(1));
    expect_no_harm(before, after);
    EXPECT_LT(done.before.min_dihedral, 1.5);
    EXPECT_GT(done.after.min_dihedral, 10);
    EXPECT_GT(done.removed_edges, 0);
    EXPECT_GT(done.moved_nodes, 0);
    EXPECT_NEAR(done.after.volume, 1, 1e-12);
  }
}

TEST(ImproveAngles, KeepsThePromiseOnWhatModellersDeliver) {
  for (const test::BrokenSurface& broken : test::broken_surfaces()) {
    if (!broken.refusal.empty()) continue;
    SCOPED_TRACE(broken.name);
    SurfaceMesh surface = broken.mesh();
    repair_mesh(surface);
    const TetMesh before = fill(surface, {.edge = broken.edge, .thickness = broken.thickness});
    const TetMesh after = fill(surface, {.edge = broken.edge, .thickness = broken.thickness, .optimize = true});
    expect_no_harm(before, after);
    test::expect_good_tets(after);
    test::expect_manifold_boundary(after);
    EXPECT_NEAR(measure_quality(after, Threads(1)).volume / broken.volume, 1, broken.tolerance);
  }
}

TEST(ImproveAngles, GivesEqualBitsAtOneAndThreeThreads) {
  const SurfaceMesh surface = test::make_torus(1, 0.35, 96, 48, Vec3(0.1, 0.2, 0.3));
  const TetMesh one = fill(surface, {.edge = 0.1, .optimize = true}, 1);
  const TetMesh three = fill(surface, {.edge = 0.1, .optimize = true}, 3);
  EXPECT_EQ(one.nodes, three.nodes);
  EXPECT_EQ(one.tets, three.tets);
}

TEST(ImproveAngles, ChangesLittleTheSecondTime) {
  const SurfaceMesh surface = test::make_torus(1, 0.35, 64, 32, Vec3::Zero());
  TetMesh mesh = fill(surface, {.edge = 0.12});
  const AngleImprovement first = improve_angles(mesh, &surface, {}, Threads(1));
  const AngleImprovement second = improve_angles(mesh, &surface, {}, Threads(1));
  EXPECT_LE(second.moved_nodes + second.slid_nodes, 0.1 * (first.moved_nodes + first.slid_nodes));
  EXPECT_LE(second.removed_edges + second.removed_faces, 0.1 * (first.removed_edges + first.removed_faces));
}

TEST(ImproveAngles, LeavesAGoodMeshAlone) {
  const TetMesh before = testing::bcc_bar({5, 4, 4}, 0.2);  // dihedral angles 60 and 90
  TetMesh after = before;
  improve_angles(after, nullptr, {}, Threads(1));
  EXPECT_EQ(after.nodes, before.nodes);
  EXPECT_EQ(after.tets, before.tets);
}

TEST(ImproveAngles, DoesNotCutTheEdgesOfABox) {
  // Sharp edges of two large triangles a side: only samples tell where the surface is.
  const SurfaceMesh surface = test::make_box({1, 0.7, 0.5}, 1, Vec3::Zero());
  const TetMesh before = fill(surface, {.edge = 0.14});
  TetMesh after = before;
  improve_angles(after, &surface, {}, Threads(1));
  const SurfaceDeviation was = measure_deviation(surface, before, Threads(1));
  const SurfaceDeviation is = measure_deviation(surface, after, Threads(1));
  EXPECT_LE(is.from_surface, 1.002 * was.from_surface);
  EXPECT_LE(is.from_boundary, 1.002 * was.two_way());
}

TEST(ImproveAngles, TakesAnEmptyMesh) {
  TetMesh mesh;
  const AngleImprovement done = improve_angles(mesh, nullptr, {}, Threads(1));
  EXPECT_EQ(done.moved_nodes + done.slid_nodes + done.removed_edges + done.removed_faces, 0);
}

TEST(ImproveAngles, RefusesWholeLatticeCells) {
  TetMesh mesh = fill(test::make_sphere(1, 8, Vec3::Zero()), {.edge = 0.4});
  mesh.fill.assign(mesh.tets.size(), 0.5);
  EXPECT_THROW(improve_angles(mesh, nullptr, {}, Threads(1)), Error);
  EXPECT_THROW(fill(test::make_sphere(1, 8, Vec3::Zero()), {.edge = 0.4, .mode = TetMode::Embedded, .optimize = true}),
               Error);
}

}  // namespace
}  // namespace softreel
