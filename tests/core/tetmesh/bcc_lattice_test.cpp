#include "core/tetmesh/lattice/bcc_lattice.h"

#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/tetmesh/lattice/lattice_nodes.h"

namespace softreel {
namespace {

Vec3 random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

bool is_node(const LatticeNode& node) {
  return ((node[0] ^ node[1]) & 1) == 0 && ((node[0] ^ node[2]) & 1) == 0;
}

TEST(LocateInLattice, WeightsReproduceThePoint) {
  const LatticeFrame frame{Vec3(0.1, -0.2, 0.3), 0.37};
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = random_point(random);
    const LatticeTet tet = locate_in_lattice(frame, p);
    Vec3 sum = Vec3::Zero();
    double total = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_TRUE(is_node(tet.nodes[k]));
      EXPECT_GE(tet.weights[k], -1e-12);
      sum += tet.weights[k] * lattice_position(frame, tet.nodes[k]);
      total += tet.weights[k];
    }
    EXPECT_NEAR((sum - p).norm(), 0, 1e-13);
    EXPECT_NEAR(total, 1, 1e-14);
  }
}

TEST(LocateInLattice, GivesTetrahedraOfTheLattice) {
  // Two long edges and four short ones.
  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    const LatticeTet tet = locate_in_lattice({Vec3::Zero(), 1.0}, random_point(random));
    std::multiset<int> squared_lengths;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) {
        int squared = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const int d = tet.nodes[a][k] - tet.nodes[b][k];
          squared += d * d;
        }
        squared_lengths.insert(squared);
      }
    EXPECT_EQ(squared_lengths, (std::multiset<int>{3, 3, 3, 3, 4, 4}));
  }
}

TEST(LocateInLattice, CoarseTetrahedraAreUnionsOfFineOnes) {
  // All of a fine element's interior lies in one coarse element.
  const LatticeFrame fine{Vec3::Zero(), 1.0}, coarse{Vec3::Zero(), 2.0};
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random_point(random);
    const LatticeTet inner = locate_in_lattice(fine, p), outer = locate_in_lattice(coarse, p);
    Vec3 center = Vec3::Zero();
    for (const LatticeNode& node : inner.nodes) center += 0.25 * lattice_position(fine, node);
    const LatticeTet of_center = locate_in_lattice(coarse, center);
    std::set<LatticeNode> a(outer.nodes.begin(), outer.nodes.end()), b(of_center.nodes.begin(), of_center.nodes.end());
    EXPECT_EQ(a, b);
    // A fine node is a coarse node or the middle of a coarse edge: weights 1, or 1/2 and 1/2.
    for (const LatticeNode& node : inner.nodes)
      for (const double w : locate_in_lattice(coarse, lattice_position(fine, node)).weights)
        EXPECT_NEAR(2 * w, std::round(2 * w), 1e-12);
  }
}

TEST(LatticeNodeSet, NumbersItsNodesDenselyAndFindsThem) {
  LatticeNodeSet set;
  std::mt19937 random(4);
  std::uniform_int_distribution<int> coordinate(-40, 40);
  std::set<LatticeNode> expected;
  for (int i = 0; i < 3000; ++i) {
    const int odd = i & 1;
    const LatticeNode node{2 * coordinate(random) + odd, 2 * coordinate(random) + odd, 2 * coordinate(random) + odd};
    EXPECT_EQ(set.insert(node), expected.insert(node).second);
  }
  set.number_nodes();
  ASSERT_EQ(set.nodes().size(), expected.size());
  for (std::size_t i = 0; i < set.nodes().size(); ++i) {
    EXPECT_TRUE(expected.contains(set.nodes()[i]));
    EXPECT_EQ(set.find(set.nodes()[i]), static_cast<Index>(i));
  }
  EXPECT_EQ(set.find({1000, 0, 0}), -1);
  EXPECT_FALSE(set.contains({1001, 1, 1}));
}

TEST(LatticeNodeSet, DirectionsAndNeighborsAreInverse) {
  const LatticeNode node{3, -5, 7};
  for (std::size_t k = 0; k < kNeighbors; ++k) {
    const LatticeNode neighbor = lattice_neighbor(node, k);
    EXPECT_TRUE(is_node(neighbor));
    EXPECT_EQ(neighbor_direction(node, neighbor), k);
    EXPECT_NE(lattice_color(node), lattice_color(neighbor));
  }
}

}  // namespace
}  // namespace softreel
