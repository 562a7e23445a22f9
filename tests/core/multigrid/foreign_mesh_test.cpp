// Meshes that no lattice made, as they come from a file: the hierarchy still covers them.
#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/multigrid/lattice_hierarchy.h"
#include "core/multigrid/multigrid.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/bcc_bar.h"
#include "tests/support/elastic_box.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

using test_support::assemble;
using test_support::ElasticParams;
using test_support::ElasticSystem;
using test_support::make_box;

/// Iterations to 1e-6 of a mesh clamped where x < edge.
int foreign_iterations(const TetMesh& mesh, double seconds, double edge = 1e-9, int axis = 0,
                       std::span<const double> stiffness = {}) {
  ElasticParams params;
  params.seconds = seconds;
  const ElasticSystem system = assemble(
      mesh, params, [&](const Vec3& x) { return x[axis] < edge; }, stiffness);
  const Threads threads(1);
  Multigrid multigrid(mesh, stiffness, system.matrix.pattern, {}, threads);
  multigrid.update(system.matrix, system.pinned);
  std::vector<Vec3> x(mesh.nodes.size(), Vec3::Zero());
  const SolveReport report = multigrid.solve(system.matrix, system.load, x, 1e-6, 0, 400);
  EXPECT_EQ(report.status, SolveStatus::Converged);
  EXPECT_FALSE(report.double_cycle && multigrid.levels().size() > 1);
  EXPECT_LE(test_support::relative_residual(system.matrix, system.load, x), 1.01e-6);
  return report.iterations;
}

LatticeHierarchy hierarchy_of(const TetMesh& mesh, std::span<const double> stiffness = {}) {
  const auto nodes = static_cast<Index>(mesh.nodes.size());
  return build_lattice_hierarchy(mesh, stiffness, stiffness_pattern(mesh.tets, nodes), {});
}

TetMesh without_lattice(TetMesh mesh) {
  mesh.lattice = {};
  return mesh;
}

double volume(const TetMesh& mesh, const Tet& tet) {
  const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
  return tet_volume(at(0), at(1), at(2), at(3));
}

/// Moves inner nodes at random by up to `reach` as long as no tetrahedron shrinks below `least` of its volume.
TetMesh shaken(TetMesh mesh, double reach, double least) {
  const Index nodes = static_cast<Index>(mesh.nodes.size());
  std::vector<std::vector<std::size_t>> around(static_cast<std::size_t>(nodes));
  std::vector<double> limit;
  Vec3 low = mesh.nodes[0], high = low;
  for (const Vec3& x : mesh.nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    limit.push_back(least * volume(mesh, mesh.tets[e]));
    for (const Index node : mesh.tets[e]) around[static_cast<std::size_t>(node)].push_back(e);
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<double> step(-reach, reach);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3 old = mesh.nodes[i], move(step(random), step(random), step(random));
    if (((old - low).array() < 1e-9).any() || ((high - old).array() < 1e-9).any()) continue;
    mesh.nodes[i] += move;
    for (const std::size_t e : around[i])
      if (volume(mesh, mesh.tets[e]) < limit[e]) mesh.nodes[i] = old;
  }
  return mesh;
}

/// A bar that tapers from 1 to 1 / ratio, with tetrahedra in proportion: graded in size, not in shape.
TetMesh tapered(const TetMesh& bar, double ratio) {
  TetMesh mesh = bar;
  const double k = std::log(ratio);
  for (Vec3& x : mesh.nodes) {
    const double scale = std::exp(-k * x[0]);
    x = Vec3((1 - scale) / k, scale * (x[1] - 0.125), scale * (x[2] - 0.125));
  }
  mesh.lattice = {};
  return mesh;
}

TEST(ForeignMesh, HasLevelsThatShrinkLikeThoseOfALattice) {
  for (const TetMesh& mesh :
       {without_lattice(testing::kuhn_bar({32, 8, 8}, Vec3(1, 0.25, 0.25))), tapered(test_support::make_bar(8), 8)}) {
    const auto nodes = static_cast<Index>(mesh.nodes.size());
    MultigridParams params;
    params.bottom_nodes = 40;
    const LatticeHierarchy hierarchy = build_lattice_hierarchy(mesh, {}, stiffness_pattern(mesh.tets, nodes), params);
    ASSERT_GE(hierarchy.levels.size(), 3u);
    for (std::size_t h = 0; h + 1 < hierarchy.levels.size(); ++h) {
      const WeightMatrix& P = hierarchy.levels[h].prolongation;
      EXPECT_LE(P.columns, 0.7 * P.rows());
      for (std::size_t i = 0; i < static_cast<std::size_t>(P.rows()); ++i)
        EXPECT_GT(P.row_offsets[i + 1], P.row_offsets[i]) << "a node of level " << h << " is not covered";
    }
  }
}

TEST(ForeignMesh, HasFewNodesLeftWhereTetrahedraOfVeryDifferentSizesAreMixed) {
  // Two of three nodes in a fine box, the others in a box of cells 8 times as large, one file.
  TetMesh mesh = make_box({18, 18, 18}, 0.01);
  const TetMesh coarse = make_box({14, 14, 14}, 0.08);
  const auto first = static_cast<Index>(mesh.nodes.size());
  for (const Vec3& x : coarse.nodes) mesh.nodes.emplace_back(x + Vec3(1, 0, 0));
  for (const Tet& t : coarse.tets) mesh.tets.push_back({t[0] + first, t[1] + first, t[2] + first, t[3] + first});
  mesh.lattice = {};
  EXPECT_LE(hierarchy_of(mesh).levels.back().pattern.rows(), static_cast<Index>(mesh.nodes.size()) / 20);
  EXPECT_LE(foreign_iterations(mesh, 1.0 / 96), 1.5 * foreign_iterations(test_support::make_bar(6), 1.0 / 96));
}

TEST(ForeignMesh, HasFewNodesLeftWhereASmallFineBodyIsJoinedToALargeCoarseOne) {
  // The small one stops shrinking long before the large one begins to: no level in between, but no end either.
  for (int k = 0; k < 8; ++k) {
    TetMesh mesh = make_box({3 + k % 3, 3, 4}, 0.01);
    const Vec3 offset(0.0037 * k, 0.0053 * k, 0.0071 * k);
    for (Vec3& x : mesh.nodes) x += offset;
    const TetMesh coarse = make_box({16, 16, 16}, 0.32);
    mesh.spacings.assign(mesh.nodes.size(), 0.01);
    const auto first = static_cast<Index>(mesh.nodes.size());
    for (const Vec3& x : coarse.nodes) mesh.nodes.emplace_back(x + Vec3(0.2, 0, 0));
    mesh.spacings.resize(mesh.nodes.size(), 0.32);
    for (const Tet& t : coarse.tets) mesh.tets.push_back({t[0] + first, t[1] + first, t[2] + first, t[3] + first});
    EXPECT_LE(hierarchy_of(mesh).levels.back().pattern.rows(), static_cast<Index>(mesh.nodes.size()) / 10) << k;
  }
}

/// Thin plate of n x n cells of 1 cm, one layer of tetrahedra.
TetMesh plate(Index n, double thickness) {
  return without_lattice(testing::kuhn_bar({n, n, 1}, Vec3(0.01 * n, 0.01 * n, thickness)));
}

TEST(ForeignMesh, IsFactoredWhereTetrahedraAreFlatAsLongAsThatIsPossible) {
  // Cycles on coarser lattices took 98 iterations at 10 to 1, and did not converge at 100 to 1.
  for (const double thickness : {1e-3, 1e-4})
    EXPECT_LE(foreign_iterations(plate(40, thickness), 1.0 / 96), 5) << thickness;
  // 250,000,000 entries of a factor and 3e11 multiply-adds: no step waits for that.
  for (const double thickness : {1e-3, 1e-4}) {
    const TetMesh large = plate(220, thickness);
    const LatticeHierarchy hierarchy = hierarchy_of(large);
    EXPECT_LE(hierarchy.levels.back().pattern.rows(), static_cast<Index>(large.nodes.size()) / 20) << thickness;
    for (std::size_t h = 0; h + 1 < hierarchy.levels.size(); ++h)
      EXPECT_LT(hierarchy.levels[h].prolongation.columns, hierarchy.levels[h].prolongation.rows());
  }
}

TEST(ForeignMesh, HasFewNodesLeftWhereManyHardGrainsAreSpread) {
  // A grain in each 27th cell, which has four coarse nodes of its own on all levels.
  const TetMesh mesh = make_box({24, 24, 24}, 0.01);
  std::vector<double> stiffness;
  for (const Tet& tet : mesh.tets) {
    Vec3 middle = Vec3::Zero();
    for (const Index node : tet) middle += mesh.nodes[static_cast<std::size_t>(node)] / 4;
    const auto hard = [&](int axis) { return std::fmod(middle[axis] / 0.01, 3) < 1; };
    stiffness.push_back(hard(0) && hard(1) && hard(2) ? 1e4 : 1.0);
  }
  EXPECT_LE(hierarchy_of(mesh, stiffness).levels.back().pattern.rows(), static_cast<Index>(mesh.nodes.size()) / 20);
  EXPECT_LE(foreign_iterations(mesh, 1.0 / 96, 1e-9, 0, stiffness), 60);
}

TEST(ForeignMesh, FindsTheLatticeOfALatticeMeshAgain) {
  const TetMesh mesh = test_support::make_bar(6);
  for (const double seconds : {0.0, 1.0 / 96})
    EXPECT_EQ(foreign_iterations(without_lattice(mesh), seconds), foreign_iterations(mesh, seconds));
}

TEST(ForeignMesh, TakesAboutTheIterationsOfALatticeMesh) {
  struct Mesh {
    const char* name;
    TetMesh mesh;
    double dynamic, still;  ///< times the iterations of the lattice mesh
  };
  const TetMesh kuhn = without_lattice(testing::kuhn_bar({32, 8, 8}, Vec3(1, 0.25, 0.25)));
  const Mesh meshes[] = {{"Kuhn", kuhn, 1.2, 1.6},
                         {"Kuhn, shaken", shaken(kuhn, 0.01, 0.1), 1.3, 1.8},
                         {"slivers of 1 % of the volume", shaken(kuhn, 0.015, 0.01), 1.7, 2.4},
                         {"graded 8 to 1", tapered(test_support::make_bar(6), 8), 1.7, 1.6}};
  const int dynamic = foreign_iterations(test_support::make_bar(6), 1.0 / 96),
            still = foreign_iterations(test_support::make_bar(6), 0);
  for (const Mesh& m : meshes) {
    EXPECT_LE(foreign_iterations(m.mesh, 1.0 / 96), m.dynamic * dynamic) << m.name;
    EXPECT_LE(foreign_iterations(m.mesh, 0), m.still * still) << m.name;
  }
}

TEST(ForeignMesh, TakesForTwoLegsAboutTheIterationsOfOne) {
  // Legs of 4 x 4 cubes, one coarse cell apart, joined by nothing but the top.
  for (const bool lattice : {true, false})
    for (const double seconds : {0.0, 1.0 / 96}) {
      TetMesh one = make_box({4, 4, 20}, 0.05);
      TetMesh two = make_box({10, 4, 20}, 0.05, [](Index x, Index, Index z) { return x < 4 || x > 5 || z > 17; });
      if (!lattice) one.lattice = two.lattice = {};
      EXPECT_LE(foreign_iterations(two, seconds, 1e-9, 2), 1.2 * foreign_iterations(one, seconds, 1e-9, 2));
    }
}

TEST(ForeignMesh, AGradedMeshConvergesTooWithMoreIterationsThanAUniformOne) {
  // A ball with a thin spike along x that asks for small tetrahedra, pinned at the other end.
  SurfaceMesh surface = test::make_sphere(1, 60, Vec3::Zero());
  for (Vec3& p : surface.positions) {
    const double across = std::hypot(p.y(), p.z());
    if (p.x() > 0 && across < 0.12) p.x() += 12 * (0.12 - across);
  }
  const Threads threads(1);
  const Log log{[](const std::string&) {}, [](const std::string& line) { ADD_FAILURE() << line; }};
  StageTimes times;
  const TetMesh graded = tetrahedralize(surface, {.error = 0.02}, "spiked", threads, log, times);
  const TetMesh uniform =
      tetrahedralize(surface, {.tets = static_cast<std::int64_t>(graded.tets.size())}, "spiked", threads, log, times);
  for (const double seconds : {0.0, 1.0 / 96})
    EXPECT_LE(foreign_iterations(graded, seconds, -0.9), 2.5 * foreign_iterations(uniform, seconds, -0.9));
}

}  // namespace
}  // namespace softreel
