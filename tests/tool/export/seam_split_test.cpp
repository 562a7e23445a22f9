// Vertices at texture seams: originals in file order first, duplicates behind, the same triangles.
#include "tool/export/seam_split.h"

#include <set>

#include "tests/tool/export/format_runs.h"

namespace softreel {
namespace {

TEST(SeamSplit, KeepsTheFilesVerticesFirstAndAddsOneForEachFurtherCoordinate) {
  const SurfaceMesh mesh = testing::patchwork();
  const SeamSplit split = split_at_seams(mesh);
  ASSERT_GE(split.sources.size(), 9U);
  for (Index v = 0; v < 9; ++v) EXPECT_EQ(split.sources[static_cast<std::size_t>(v)], v);
  // As many vertices as there are pairs of vertex and coordinate, and the one that nothing uses.
  std::set<std::pair<Index, Index>> pairs;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) pairs.emplace(mesh.triangles[t][c], mesh.triangle_textures[t][c]);
  EXPECT_EQ(split.sources.size(), pairs.size() + 1);
  EXPECT_GT(split.sources.size(), 9U) << "the mesh was to have a seam";
}

TEST(SeamSplit, GivesEachCornerItsVertexAndItsCoordinate) {
  const SurfaceMesh mesh = testing::patchwork();
  const SeamSplit split = split_at_seams(mesh);
  ASSERT_EQ(split.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto vertex = static_cast<std::size_t>(split.triangles[t][c]);
      EXPECT_EQ(split.sources[vertex], mesh.triangles[t][c]);
      const Vec2 texture = mesh.texture_coordinates[static_cast<std::size_t>(mesh.triangle_textures[t][c])];
      EXPECT_EQ(split.textures[vertex], texture.cast<float>());
    }
}

TEST(SeamSplit, CountsEqualCoordinatesAsOneAndLeavesMeshesWithoutAlone) {
  SurfaceMesh mesh = testing::unit_box();
  EXPECT_EQ(split_at_seams(mesh).sources.size(), 8U);
  EXPECT_TRUE(split_at_seams(mesh).textures.empty());
  mesh.texture_coordinates = {Vec2(0.5, 0.5), Vec2(0.5, 0.5)};
  mesh.triangle_textures.assign(mesh.triangles.size(), Triangle{0, 1, 0});
  EXPECT_EQ(split_at_seams(mesh).sources.size(), 8U);
}

}  // namespace
}  // namespace softreel
