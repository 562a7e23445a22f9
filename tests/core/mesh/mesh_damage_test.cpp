#include "core/mesh/mesh_damage.h"

#include <gtest/gtest.h>

#include "core/mesh/mesh_check.h"
#include "core/mesh/mesh_repair.h"
#include "tests/core/mesh/mesh_files.h"
#include "tests/support/broken_surfaces.h"

namespace softreel {
namespace {

using testing::unit_box;

MeshDamage damage_of(const SurfaceMesh& mesh) {
  SurfaceMesh repaired = mesh;
  repair_mesh(repaired);
  return find_damage(mesh, repaired);
}

TEST(FindDamage, FindsNothingOnABox) {
  EXPECT_TRUE(damage_of(unit_box()).empty());
}

TEST(FindDamage, AMissingTriangleLeavesItsThreeEdges) {
  SurfaceMesh mesh = unit_box();
  const Triangle lost = mesh.triangles.back();
  mesh.triangles.pop_back();
  mesh.triangle_polygon.pop_back();
  const MeshDamage damage = damage_of(mesh);
  ASSERT_EQ(damage.boundary.size(), 3U);
  for (const auto& [a, b] : damage.boundary) {
    EXPECT_LT(a, b);
    for (const Index end : {a, b}) EXPECT_NE(std::find(lost.begin(), lost.end(), end), lost.end());
  }
  EXPECT_TRUE(damage.non_manifold.empty() && damage.flipped.empty() && damage.turned.empty());
}

TEST(FindDamage, ATurnedTriangleIsNamedWithItsEdges) {
  SurfaceMesh mesh = unit_box();
  std::swap(mesh.triangles[4][1], mesh.triangles[4][2]);
  const MeshDamage damage = damage_of(mesh);
  EXPECT_EQ(damage.turned, std::vector<Index>{4});
  EXPECT_EQ(damage.flipped.size(), 3U);
}

TEST(FindDamage, ABoxInsideOutIsTurnedAsAWhole) {
  SurfaceMesh mesh = unit_box();
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  const MeshDamage damage = damage_of(mesh);
  EXPECT_EQ(damage.turned.size(), mesh.triangles.size());
  EXPECT_TRUE(damage.flipped.empty());
}

TEST(FindDamage, CountsWhatCheckMeshCounts) {
  for (const test::BrokenSurface& surface : test::broken_surfaces()) {
    SCOPED_TRACE(surface.name);
    const SurfaceMesh mesh = surface.mesh();
    const MeshFacts facts = check_mesh(mesh);
    const MeshDamage damage = find_damage(mesh, mesh);
    EXPECT_EQ(static_cast<std::int64_t>(damage.boundary.size()), facts.boundary_edges);
    EXPECT_EQ(static_cast<std::int64_t>(damage.non_manifold.size()), facts.non_manifold_edges);
    EXPECT_EQ(static_cast<std::int64_t>(damage.flipped.size()), facts.flipped_neighbours);
    EXPECT_TRUE(damage.turned.empty()) << "nothing differs from itself";
  }
}

}  // namespace
}  // namespace softreel
