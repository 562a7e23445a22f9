#include "core/sparse/block_matrix.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

TEST(StiffnessPattern, OfOneTetIsFull) {
  const BlockPattern pattern = stiffness_pattern({{0, 1, 2, 3}}, 4);
  EXPECT_EQ(pattern.rows(), 4);
  EXPECT_EQ(pattern.columns, 4);
  EXPECT_EQ(pattern.blocks(), 16);
  for (Index i = 0; i < 4; ++i)
    for (Index j = 0; j < 4; ++j) EXPECT_EQ(pattern.find(i, j), 4 * i + j);
}

TEST(StiffnessPattern, GivesANodeOfNoElementItsDiagonalOnly) {
  const BlockPattern pattern = stiffness_pattern({{0, 1, 2, 4}}, 6);
  EXPECT_EQ(pattern.blocks(), 18);
  EXPECT_GE(pattern.find(3, 3), 0);
  EXPECT_GE(pattern.find(5, 5), 0);
  EXPECT_EQ(pattern.find(3, 2), -1);
  EXPECT_EQ(pattern.find(0, 5), -1);
}

TEST(StiffnessPattern, HasABlockExactlyWhereAnElementHasBothNodes) {
  const TetMesh mesh = test_support::make_box({2, 1, 1}, 1.0);
  const auto nodes = static_cast<Index>(mesh.nodes.size());
  const BlockPattern pattern = stiffness_pattern(mesh.tets, nodes);
  for (Index i = 0; i < nodes; ++i)
    for (Index j = 0; j < nodes; ++j) {
      const bool together = i == j || std::any_of(mesh.tets.begin(), mesh.tets.end(), [&](const Tet& tet) {
                              return std::count(tet.begin(), tet.end(), i) && std::count(tet.begin(), tet.end(), j);
                            });
      EXPECT_EQ(pattern.find(i, j) >= 0, together) << i << " " << j;
      if (!together) continue;
      EXPECT_EQ(pattern.column_indices[static_cast<std::size_t>(pattern.find(i, j))], j);
    }
}

TEST(StiffnessPattern, ColumnsAscend) {
  const TetMesh mesh = test_support::make_box({3, 2, 2}, 1.0);
  const BlockPattern pattern = stiffness_pattern(mesh.tets, static_cast<Index>(mesh.nodes.size()));
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const auto begin = pattern.column_indices.begin() + pattern.row_offsets[i];
    const auto end = pattern.column_indices.begin() + pattern.row_offsets[i + 1];
    EXPECT_EQ(std::adjacent_find(begin, end, std::greater_equal<>()), end);
  }
}

}  // namespace
}  // namespace softreel
