// The parts that no matrix value changes: coarse nodes, transfer weights, colours, levels.
#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "core/multigrid/lattice_hierarchy.h"
#include "core/multigrid/transfer.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using test_support::make_box;

BlockPattern pattern_of(const TetMesh& mesh) {
  return stiffness_pattern(mesh.tets, static_cast<Index>(mesh.nodes.size()));
}

Coarsening coarsen_once(const TetMesh& mesh, const CoarseningParams& params, std::vector<double> stiffness = {}) {
  return coarsen({mesh.nodes, std::move(stiffness)}, pattern_of(mesh), {mesh.lattice.origin, 2 * mesh.lattice.spacing},
                 params);
}

/// Nodes moved a little, as isosurface stuffing warps them.
TetMesh warped(TetMesh mesh) {
  for (Vec3& x : mesh.nodes)
    x += 0.15 * mesh.lattice.spacing * Vec3(std::sin(7 * x[1]), std::cos(5 * x[2]), std::sin(11 * x[0]));
  return mesh;
}

TEST(Coarsen, KeepsConstantsExactly) {
  const Coarsening coarse = coarsen_once(warped(make_box({5, 3, 4}, 0.2)), {});
  const WeightMatrix& P = coarse.prolongation;
  for (std::size_t i = 0; i < static_cast<std::size_t>(P.rows()); ++i) {
    double sum = 0;
    for (std::int64_t e = P.row_offsets[i]; e < P.row_offsets[i + 1]; ++e) {
      EXPECT_GE(P.weights[static_cast<std::size_t>(e)], 0.1);
      sum += P.weights[static_cast<std::size_t>(e)];
    }
    EXPECT_NEAR(sum, 1, 1e-14);
  }
}

TEST(Coarsen, KeepsAffineFieldsExactlyIfNoWeightIsDropped) {
  const TetMesh mesh = warped(make_box({5, 3, 4}, 0.2));
  CoarseningParams params;
  params.dropped_weight = 0;
  const Coarsening coarse = coarsen_once(mesh, params);
  const WeightMatrix& P = coarse.prolongation;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    Vec3 position = Vec3::Zero();
    for (std::int64_t e = P.row_offsets[i]; e < P.row_offsets[i + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      position += P.weights[entry] * coarse.nodes.positions[static_cast<std::size_t>(P.column_indices[entry])];
    }
    EXPECT_LE((position - mesh.nodes[i]).norm(), 1e-13);
  }
}

TEST(Coarsen, MakesFineLatticeNodesCoarseNodesOrMiddlesOfCoarseEdges) {
  const Coarsening coarse = coarsen_once(make_box({6, 4, 4}, 1.0), {});
  for (const double weight : coarse.prolongation.weights) EXPECT_TRUE(weight == 1.0 || weight == 0.5) << weight;
  for (std::size_t i = 0; i < static_cast<std::size_t>(coarse.prolongation.rows()); ++i)
    EXPECT_LE(coarse.prolongation.row_offsets[i + 1] - coarse.prolongation.row_offsets[i], 2);
}

/// Coarse nodes that serve fine nodes on both sides of the plane x = middle.
int shared_nodes(const TetMesh& mesh, const Coarsening& coarse, double middle) {
  const WeightMatrix R = transpose(coarse.prolongation);
  int shared = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(R.rows()); ++j) {
    bool left = false, right = false;
    for (std::int64_t e = R.row_offsets[j]; e < R.row_offsets[j + 1]; ++e) {
      const double x = mesh.nodes[static_cast<std::size_t>(R.column_indices[static_cast<std::size_t>(e)])][0];
      (x < middle ? left : right) = true;
    }
    shared += left && right;
  }
  return shared;
}

TEST(Coarsen, CopiesNodesBetweenLegsThatDoNotTouch) {
  // Two columns one cube apart: every coarse node between them would reach both.
  const TetMesh mesh = make_box({3, 6, 1}, 1.0, [](Index x, Index, Index) { return x != 1; });
  EXPECT_EQ(shared_nodes(mesh, coarsen_once(mesh, {}), 1.5), 0);
  const TetMesh joined = make_box({3, 6, 1}, 1.0);
  EXPECT_GT(shared_nodes(joined, coarsen_once(joined, {}), 1.5), 0);
}

/// Per block, 1 or `factor` where an element with its centre at `stiff` has both nodes.
std::vector<double> stiffness_where(const TetMesh& mesh, double factor, const std::function<bool(const Vec3&)>& stiff) {
  const BlockPattern pattern = pattern_of(mesh);
  std::vector<double> values(static_cast<std::size_t>(pattern.blocks()), 1);
  for (const Tet& tet : mesh.tets) {
    Vec3 center = Vec3::Zero();
    for (const Index node : tet) center += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
    if (!stiff(center)) continue;
    for (const Index i : tet)
      for (const Index j : tet) values[static_cast<std::size_t>(pattern.find(i, j))] = factor;
  }
  return values;
}

TEST(Coarsen, CopiesNodesPerSideOfAStiffnessContrast) {
  const TetMesh mesh = make_box({6, 2, 2}, 1.0);
  // The stiff half ends at x = 3 with pyramids whose tips are at 3.5.
  const auto left = [](const Vec3& x) { return x[0] < 3.2; };
  EXPECT_EQ(shared_nodes(mesh, coarsen_once(mesh, {}, stiffness_where(mesh, 100, left)), 3.6), 0);
  EXPECT_GT(shared_nodes(mesh, coarsen_once(mesh, {}, stiffness_where(mesh, 5, left)), 3.6), 0);
}

TEST(Coarsen, DoesNotJoinTwoInclusionsAcrossASoftLayer) {
  const TetMesh mesh = make_box({7, 2, 2}, 1.0);
  // Soft between x = 3 and 4 only: soft elements join the stiff nodes of either side.
  const auto ends = [](const Vec3& x) { return x[0] < 3 || x[0] > 4; };
  EXPECT_EQ(shared_nodes(mesh, coarsen_once(mesh, {}, stiffness_where(mesh, 1000, ends)), 3.5), 0);
}

TEST(LatticeHierarchy, RowsOfAColorShareNoBlockAndColorsAscendFromTheDiagonal) {
  const TetMesh mesh = warped(make_box({8, 4, 4}, 0.5));
  const LatticeHierarchy hierarchy = build_lattice_hierarchy(mesh, {}, pattern_of(mesh), {});
  for (const LatticeLevel& level : hierarchy.levels) {
    ASSERT_EQ(level.color_offsets.back(), level.pattern.rows());
    for (std::size_t color = 0; color + 1 < level.color_offsets.size(); ++color) {
      const Index begin = level.color_offsets[color], end = level.color_offsets[color + 1];
      for (Index i = begin; i < end; ++i)
        for (std::int64_t b = level.pattern.row_offsets[static_cast<std::size_t>(i)];
             b < level.pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++b) {
          const Index j = level.pattern.column_indices[static_cast<std::size_t>(b)];
          EXPECT_TRUE(j == i || j < begin || j >= end);
        }
    }
    for (Index i = 0; i < level.pattern.rows(); ++i)
      EXPECT_EQ(level.diagonal[static_cast<std::size_t>(i)], level.pattern.find(i, i));
  }
}

// Eight inside; less where the boundary, which needs nodes beyond it, is a large part.
TEST(LatticeHierarchy, ShrinksAtLeastByThreeToTheBottom) {
  const TetMesh mesh = make_box({20, 10, 10}, 0.1);
  const LatticeHierarchy hierarchy = build_lattice_hierarchy(mesh, {}, pattern_of(mesh), {});
  ASSERT_GE(hierarchy.levels.size(), 3u);
  EXPECT_LE(20 * hierarchy.levels.back().pattern.rows(), hierarchy.levels.front().pattern.rows());
  for (std::size_t h = 0; h + 1 < hierarchy.levels.size(); ++h)
    EXPECT_GE(hierarchy.levels[h].pattern.rows(), 3 * hierarchy.levels[h + 1].pattern.rows());
}

TEST(LatticeHierarchy, StopsEarlyWhereTheFactorsAreCheap) {
  const TetMesh rod = make_box({200, 1, 1}, 0.1), block = make_box({14, 14, 14}, 0.1);
  EXPECT_GT(build_lattice_hierarchy(rod, {}, pattern_of(rod), {}).levels.back().pattern.rows(), 150);
  EXPECT_LE(build_lattice_hierarchy(block, {}, pattern_of(block), {}).levels.back().pattern.rows(), 300);
}

TEST(LatticeHierarchy, NumbersEveryMeshNodeAndBlockOnce) {
  const TetMesh mesh = make_box({5, 4, 4}, 0.1);
  const BlockPattern pattern = pattern_of(mesh);
  const LatticeHierarchy hierarchy = build_lattice_hierarchy(mesh, {}, pattern, {});
  EXPECT_EQ(std::set<Index>(hierarchy.mesh_nodes.begin(), hierarchy.mesh_nodes.end()).size(), mesh.nodes.size());
  const LatticeLevel& finest = hierarchy.levels.front();
  for (Index i = 0; i < finest.pattern.rows(); ++i)
    for (std::int64_t b = finest.pattern.row_offsets[static_cast<std::size_t>(i)];
         b < finest.pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++b) {
      const Index j = finest.pattern.column_indices[static_cast<std::size_t>(b)];
      EXPECT_EQ(hierarchy.source_blocks[static_cast<std::size_t>(b)],
                pattern.find(hierarchy.mesh_nodes[static_cast<std::size_t>(j)],
                             hierarchy.mesh_nodes[static_cast<std::size_t>(i)]));
    }
}

TEST(LatticeHierarchy, CoversAMeshWithoutALattice) {
  TetMesh mesh = warped(make_box({10, 5, 5}, 0.1));
  mesh.lattice = {};
  const LatticeHierarchy hierarchy = build_lattice_hierarchy(mesh, {}, pattern_of(mesh), {});
  ASSERT_GE(hierarchy.levels.size(), 2u);
  EXPECT_GE(hierarchy.levels[0].pattern.rows(), 3 * hierarchy.levels[1].pattern.rows());
}

std::vector<Index> level_sizes(const TetMesh& mesh, const std::vector<double>& stiffness) {
  std::vector<Index> sizes;
  for (const LatticeLevel& level : build_lattice_hierarchy(mesh, stiffness, pattern_of(mesh), {}).levels)
    sizes.push_back(level.pattern.rows());
  return sizes;
}

TEST(LatticeHierarchy, LeavesCopiesOutWhereStiffAndSoftElementsAreMixedOneByOne) {
  const TetMesh mesh = make_box({16, 6, 6}, 0.1);
  std::vector<double> mixed, halves;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    mixed.push_back(e * 2654435761u % 1000 < 100 ? 1e6 : 1);
    halves.push_back(mesh.nodes[static_cast<std::size_t>(mesh.tets[e][0])][0] < 0.75 ? 1e6 : 1);
  }
  EXPECT_EQ(level_sizes(mesh, mixed), level_sizes(mesh, {}));
  EXPECT_GT(level_sizes(mesh, halves)[1], level_sizes(mesh, {})[1]) << "few copies stay";
}

TEST(LatticeHierarchy, EndsWhereSeparatePiecesCannotGetFewer) {
  // 343 cubes that do not touch: each keeps its own coarse nodes, however coarse the lattice.
  const TetMesh mesh =
      make_box({13, 13, 13}, 1.0, [](Index x, Index y, Index z) { return x % 2 + y % 2 + z % 2 == 0; });
  const LatticeHierarchy hierarchy = build_lattice_hierarchy(mesh, {}, pattern_of(mesh), {});
  EXPECT_GE(hierarchy.levels.back().pattern.rows(), 343);
}

}  // namespace
}  // namespace softreel
