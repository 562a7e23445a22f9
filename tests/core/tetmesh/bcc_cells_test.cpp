#include "core/tetmesh/cells/bcc_cells.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace softreel {
namespace {

std::vector<BccCell> all_types() {
  std::vector<BccCell> cells;
  for (std::uint8_t type = 0; type < kCellTypes; ++type) cells.push_back({{-3, 5, 7}, type});
  return cells;
}

Vec3 point(const LatticeNode& node) {
  return {static_cast<double>(node[0]), static_cast<double>(node[1]), static_cast<double>(node[2])};
}

TEST(BccCell, HasOneVolumeAndOrientation) {
  for (const BccCell& cell : all_types()) {
    const auto x = cell_corners(cell);
    EXPECT_DOUBLE_EQ(tet_volume(point(x[0]), point(x[1]), point(x[2]), point(x[3])), 2.0 / 3);  // 8 units^3 over 12
    EXPECT_EQ(cell_of_key(cell_key(cell)), cell);
  }
}

TEST(BccCell, SharesThreeCornersWithEachNeighbor) {
  for (const BccCell& cell : all_types())
    for (std::size_t face = 0; face < 4; ++face) {
      const CellNeighbor neighbor = cell_neighbor(cell, face);
      const auto own = cell_corners(cell), other = cell_corners(neighbor.cell);
      EXPECT_FALSE(neighbor.cell == cell);
      for (std::size_t k = 0; k < 4; ++k)
        if (k != face) {
          EXPECT_EQ(other[neighbor.corner[k]], own[k]);
        }
      EXPECT_EQ(std::find(own.begin(), own.end(), other[neighbor.face]), own.end());
      EXPECT_EQ(cell_neighbor(neighbor.cell, neighbor.face).cell, cell);
    }
}

TEST(BccCell, IsOneOfTwentyFourRoundEachOfItsCorners) {
  for (const LatticeNode& node : {LatticeNode{1, -3, 5}, LatticeNode{2, 0, -4}}) {
    std::set<std::uint64_t> keys;
    for (const BccCell& cell : cells_around(node)) {
      const auto corners = cell_corners(cell);
      EXPECT_NE(std::find(corners.begin(), corners.end(), node), corners.end());
      keys.insert(cell_key(cell));
    }
    EXPECT_EQ(keys.size(), 24u);
  }
}

TEST(BccCell, ContainsThePointsThatAreLocatedInIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-9, 9);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p(coordinate(random), coordinate(random), coordinate(random));
    const BccCell cell = cell_at(p);
    const Vec4 weights = cell_weights(cell, p);
    EXPECT_GE(weights.minCoeff(), -1e-12);
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) sum += weights[static_cast<Index>(k)] * point(cell_corners(cell)[k]);
    EXPECT_LT((sum - p).norm(), 1e-13 * 20);
  }
}

}  // namespace
}  // namespace softreel
