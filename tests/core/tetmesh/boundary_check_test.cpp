#include "core/tetmesh/quality/boundary_check.h"

#include <gtest/gtest.h>

#include "tests/support/bcc_bar.h"

namespace softreel {
namespace {

BoundaryDefects check(const TetMesh& mesh) {
  return check_boundary(mesh.nodes, find_boundary(mesh));
}

TEST(CheckBoundary, FindsNothingAtBars) {
  EXPECT_TRUE(check(testing::bcc_bar({4, 3, 3}, 0.1)).none());
  EXPECT_TRUE(check(testing::kuhn_bar({4, 2, 3}, Vec3(1, 1, 1))).none());
}

/// Two tetrahedra that share `shared` nodes.
TetMesh pair(int shared) {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.tets = {{0, 1, 2, 3}};
  if (shared == 1) mesh.tets.push_back({0, 4, 6, 5});
  if (shared == 2) mesh.tets.push_back({0, 3, 4, 5});
  if (shared == 3) mesh.tets.push_back({0, 2, 1, 6});
  for (Tet& tet : mesh.tets) tet = testing::oriented(tet, mesh.nodes);
  return mesh;
}

TEST(CheckBoundary, TellsVerticesEdgesAndFacesApart) {
  const BoundaryDefects vertex = check(pair(1)), edge = check(pair(2));
  EXPECT_EQ(vertex.edges, 0);
  EXPECT_EQ(vertex.vertices, 1);
  EXPECT_EQ(vertex.first, Vec3(0, 0, 0));
  EXPECT_EQ(edge.edges, 1);
  EXPECT_EQ(edge.first, Vec3(0, 0, 0.5));
  EXPECT_TRUE(check(pair(3)).none());
}

TEST(CheckBoundary, SeesAFaceThatIsMissingOrTurned) {
  const TetMesh mesh = pair(3);
  std::vector<BoundaryFace> faces = find_boundary(mesh);
  std::swap(faces[0].nodes[0], faces[0].nodes[1]);
  EXPECT_EQ(check_boundary(mesh.nodes, faces).edges, 3);
  faces.erase(faces.begin());
  EXPECT_EQ(check_boundary(mesh.nodes, faces).edges, 3);
}

}  // namespace
}  // namespace softreel
