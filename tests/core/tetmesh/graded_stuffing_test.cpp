#include "core/tetmesh/graded/graded_stuffing.h"

#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/tetmesh/stuffing/boundary_mending.h"
#include "tests/support/tet_checks.h"

namespace softreel {
namespace {

constexpr std::int32_t kTop = 3;

Bounds box_of(double half_size) {
  Bounds box;
  box.add(Vec3::Constant(-half_size));
  box.add(Vec3::Constant(half_size));
  return box;
}

/// An octree in the cube of half size 1.2, refined at random points to random levels.
GradedOctree random_octree(std::mt19937& random, double spacing) {
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  GradedOctree octree({Vec3(0.01, 0.02, 0.03), spacing}, box_of(1.2), kTop);
  for (std::int32_t k = 0; k < 20; ++k) octree.refine(Vec3(value(random), value(random), value(random)), k % kTop, 0.5);
  return octree;
}

/// All tetrahedra between the leaves.
TetMesh background(const GradedOctree& octree) {
  const LatticeNodeSet nodes = octree.nodes();
  TetMesh mesh;
  for (const LatticeNode& node : nodes.nodes()) mesh.nodes.push_back(lattice_position(octree.frame(), node));
  octree.visit_tets(nodes, [&](const std::array<LatticeNode, 4>& tet) {
    mesh.tets.push_back({nodes.find(tet[0]), nodes.find(tet[1]), nodes.find(tet[2]), nodes.find(tet[3])});
  });
  return mesh;
}

std::vector<double> values_at(const GradedOctree& octree, const LatticeNodeSet& nodes,
                              const std::function<double(const Vec3&)>& value) {
  std::vector<double> values;
  for (const LatticeNode& node : nodes.nodes()) values.push_back(value(lattice_position(octree.frame(), node)));
  return values;
}

TEST(GradedOctree, LeavesThatTouchAtAFaceOrAnEdgeDifferByOneLevel) {
  std::mt19937 random(1);
  const GradedOctree octree = random_octree(random, 0.08);
  const double unit = 0.5 * octree.frame().spacing;
  std::set<std::int32_t> levels;
  for (const OctreeCell& cell : octree.cells()) {
    if (cell.first_child >= 0) continue;
    levels.insert(cell.level);
    const Vec3 center = lattice_position(octree.frame(), cell.center());
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          if (std::abs(dx) + std::abs(dy) + std::abs(dz) > 2) continue;
          const Vec3 beside = center + (0.5 * cell.width() + 0.5) * unit * Vec3(dx, dy, dz);
          EXPECT_LE(octree.level_at(beside), cell.level + 1);
        }
  }
  EXPECT_EQ(levels.size(), 4U);
}

TEST(GradedOctree, RefinesRoundAPointAndATriangle) {
  GradedOctree octree({Vec3::Zero(), 0.05}, box_of(1), kTop);
  const Vec3 a(0.3, 0.2, 0.1), b(-0.5, 0.7, 0.2), c(0.1, -0.6, -0.8);
  EXPECT_EQ(octree.level_at(a), kTop);
  octree.refine(a, 1, 0);
  EXPECT_EQ(octree.level_at(a), 1);
  octree.refine({a, b, c}, 0);
  for (double s = 0; s <= 1; s += 0.125)
    for (double t = 0; s + t <= 1; t += 0.125) EXPECT_EQ(octree.level_at(a + s * (b - a) + t * (c - a)), 0);
}

TEST(GradedOctree, TetrahedraFillTheLeavesWithoutGapsAndWithGoodAngles) {
  std::mt19937 random(2);
  for (int i = 0; i < 3; ++i) {
    const GradedOctree octree = random_octree(random, 0.09);
    const TetMesh mesh = background(octree);
    const TetQuality quality = measure_quality(mesh, Threads(1));
    EXPECT_GT(quality.min_volume, 0);
    EXPECT_NEAR(quality.min_dihedral, 45, 1e-9);
    EXPECT_NEAR(quality.max_dihedral, 120, 1e-9);
    EXPECT_EQ(test::count_pieces(mesh), 1);
    // A gap would show as a boundary inside, where no corner of the outermost cells is.
    test::expect_manifold_boundary(mesh);
    EXPECT_EQ(test::euler_characteristic(mesh), 2);
  }
}

TEST(StuffOctree, FillsABallAcrossAllSizes) {
  std::mt19937 random(3);
  for (int i = 0; i < 4; ++i) {
    GradedOctree octree = random_octree(random, 0.06);
    const LatticeNodeSet nodes = octree.nodes();
    StuffedMesh stuffed =
        stuff_octree(octree, nodes, values_at(octree, nodes, [](const Vec3& p) { return p.norm() - 1; }));
    mend_boundary(stuffed);
    const TetQuality quality = measure_quality(stuffed.mesh, Threads(1));
    EXPECT_GT(quality.min_volume, 0);
    EXPECT_GE(quality.min_dihedral, kMinGradedDihedral);
    EXPECT_LE(quality.max_dihedral, kMaxGradedDihedral);
    EXPECT_NEAR(quality.volume, 4.0 / 3.0 * std::numbers::pi, 0.15);
    test::expect_manifold_boundary(stuffed.mesh);
    EXPECT_EQ(test::euler_characteristic(stuffed.mesh), 2);
    EXPECT_EQ(test::count_pieces(stuffed.mesh), 1);
  }
}

TEST(StuffOctree, KeepsItsAnglesForRandomOctreesAndValues) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::size_t count = 0;
  for (int i = 0; i < 9; ++i) {
    const GradedOctree octree = random_octree(random, 0.08);
    const LatticeNodeSet nodes = octree.nodes();
    const auto noise = [&](const Vec3& p) {
      const double x = value(random);
      if (p.cwiseAbs().maxCoeff() > 0.8) return 1.0;
      return i % 3 == 0 ? x : i % 3 == 1 ? x * x * x : std::copysign(std::exp(1.2 * value(random)), x);
    };
    StuffedMesh stuffed = stuff_octree(octree, nodes, values_at(octree, nodes, noise));
    count += stuffed.mesh.tets.size();
    mend_boundary(stuffed);
    test::expect_manifold_boundary(stuffed.mesh);
    const TetQuality quality = measure_quality(stuffed.mesh, Threads(1));
    EXPECT_GT(quality.min_volume, 0);
    EXPECT_GE(quality.min_dihedral, kMinGradedDihedral);
    EXPECT_LE(quality.max_dihedral, kMaxGradedDihedral);
  }
  EXPECT_GT(count, 50000U);
}

TEST(StuffOctree, OfOneSizeHasTheVolumeOfTheUniformLattice) {
  const LatticeFrame frame{Vec3(0.01, 0.02, 0.03), 0.1};
  GradedOctree octree(frame, box_of(1.2), 0);
  const LatticeNodeSet nodes = octree.nodes();
  const auto ball = [](const Vec3& p) { return p.norm() - 1; };
  const TetMesh graded = stuff_octree(octree, nodes, values_at(octree, nodes, ball)).mesh;
  const TetMesh uniform = stuff_isosurface(sample_distance(frame, box_of(1.2), ball), Threads(1)).mesh;
  EXPECT_NEAR(measure_quality(graded, Threads(1)).volume, measure_quality(uniform, Threads(1)).volume, 1e-3);
  EXPECT_NEAR(static_cast<double>(graded.tets.size()) / static_cast<double>(uniform.tets.size()), 1, 0.1);
}

}  // namespace
}  // namespace softreel
