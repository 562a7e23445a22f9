/// Tunnels of surfaces, and of thin walls that tetrahedra perforate.
#include "core/tetmesh/quality/tunnels.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/mesh/mesh_topology.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "tests/support/damaged_shapes.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

/// The tetrahedra of a body, and the lines about it.
TetMesh fill(const SurfaceMesh& surface, const TetrahedralizeParams& params, std::string& said) {
  const auto collect = [&said](const std::string& line) { said += line + "\n"; };
  StageTimes times;
  return tetrahedralize(surface, params, "body", Threads(1), {collect, collect}, times);
}

Index tunnels_of(const TetMesh& mesh) {
  const std::optional<Index> count = count_tunnels(boundary_faces(mesh));
  EXPECT_TRUE(count.has_value()) << "the boundary is open";
  return count.value_or(-1);
}

TEST(CountTunnels, OfKnownSurfaces) {
  const SurfaceMesh sphere = test::make_sphere(1, 6, Vec3::Zero());
  const SurfaceMesh torus = test::make_torus(1, 0.3, 24, 12, Vec3(5, 0, 0));
  EXPECT_EQ(count_tunnels(welded_triangles(sphere)), 0);
  EXPECT_EQ(count_tunnels(welded_triangles(torus)), 1);
  EXPECT_EQ(count_tunnels(welded_triangles(test::with(sphere, torus))), 1) << "apart, as two pieces";
  EXPECT_EQ(count_tunnels(welded_triangles(test::with(torus, test::moved(torus, 1, Vec3(9, 0, 0))))), 2);
  SurfaceMesh open = sphere;
  open.triangles.pop_back();
  EXPECT_EQ(count_tunnels(welded_triangles(open)), std::nullopt);
}

TEST(CountTunnels, OfManifoldsWithoutASort) {
  const SurfaceMesh sphere = test::make_sphere(1, 6, Vec3::Zero());
  const SurfaceMesh torus = test::make_torus(1, 0.3, 24, 12, Vec3(5, 0, 0));
  EXPECT_EQ(count_manifold_tunnels({}), 0);
  for (const SurfaceMesh& mesh :
       {sphere, torus, test::with(sphere, torus), test::with(torus, test::moved(torus, 2, Vec3(9, 0, 0)))}) {
    const std::vector<Triangle> welded = welded_triangles(mesh);
    EXPECT_EQ(count_manifold_tunnels(welded), count_tunnels(welded));
  }
}

TEST(CountTunnels, TakesSpheresThatTouchAtAVertexForTwo) {
  const SurfaceMesh sphere = test::make_box(Vec3(1, 1, 1), 2, Vec3::Zero());
  EXPECT_EQ(count_tunnels(welded_triangles(test::with(sphere, test::moved(sphere, 1, Vec3(2, 2, 2))))), 0);
}

TEST(Tunnels, ThatTheSurfaceHasAreNotSpokenOf) {
  std::string said;
  const TetMesh mesh = fill(test::make_torus(1, 0.3, 48, 24, Vec3::Zero()), {.tets = 8000}, said);
  EXPECT_EQ(tunnels_of(mesh), 1);
  EXPECT_EQ(said.find("tunnel"), std::string::npos) << said;
}

/// A box of 1 m without a lid, its walls a tenth thick.
SurfaceMesh cup() {
  const double out = 0.5, in = 0.4, floor = 0.1;
  SurfaceMesh mesh;
  for (const auto& [half, low] : {std::pair(out, 0.0), std::pair(in, floor)})
    for (const double y : {low, 1.0})
      for (const auto& [x, z] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
        mesh.positions.emplace_back(half * x, y, half * z);
  const auto quad = [&](Index a, Index b, Index c, Index d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  quad(0, 1, 2, 3);    // below
  quad(8, 11, 10, 9);  // the floor inside
  for (Index k = 0; k < 4; ++k) {
    const Index next = (k + 1) % 4;
    quad(k, 4 + k, 4 + next, next);            // outside
    quad(8 + k, 8 + next, 12 + next, 12 + k);  // inside
    quad(4 + k, 12 + k, 12 + next, 4 + next);  // the rim
  }
  return mesh;
}

TEST(Tunnels, AreAvoidedWhereAnotherLatticeOfTheCountHasNone) {
  std::string said;
  const TetMesh sieve = fill(cup(), {.edge = 0.105}, said);
  ASSERT_GT(tunnels_of(sieve), 0);
  EXPECT_NE(said.find("tunnel"), std::string::npos) << said;
  said.clear();
  const TetMesh mesh = fill(cup(), {.tets = static_cast<std::int64_t>(sieve.tets.size())}, said);
  EXPECT_EQ(tunnels_of(mesh), 0);
  EXPECT_NEAR(static_cast<double>(mesh.tets.size()) / static_cast<double>(sieve.tets.size()), 1, 0.05);
}

TEST(Tunnels, OfThinWallsAreAvoidedOrSaid) {
  for (const std::int64_t tets : {5000, 6000, 7000, 9000, 12000}) {
    std::string said;
    const TetMesh mesh = fill(cup(), {.tets = tets}, said);
    const Index tunnels = tunnels_of(mesh);
    EXPECT_EQ(said.find("tunnel") != std::string::npos, tunnels > 0)
        << tets << " tetrahedra, " << tunnels << ": " << said;
  }
}

/// 1 m square, 2 cm thick.
SurfaceMesh plate() {
  return test::make_box(Vec3(0.5, 0.01, 0.5), 8, Vec3::Zero());
}

TEST(Tunnels, AreAvoidedInGradedPlatesThatHaveTheCountForEvenEdges) {
  for (const std::int64_t tets : {22000, 40000}) {
    std::string said;
    const TetMesh mesh = fill(plate(), {.tets = tets, .graded = true}, said);
    EXPECT_EQ(tunnels_of(mesh), 0) << tets;
    EXPECT_NEAR(static_cast<double>(mesh.tets.size()) / static_cast<double>(tets), 1, 0.05);
    EXPECT_EQ(said, "");
  }
}

TEST(Tunnels, OfAPlateThatIsASieveAreCounted) {
  std::string said;
  const TetMesh mesh = fill(plate(), {.edge = 0.036}, said);
  const Index tunnels = tunnels_of(mesh);
  ASSERT_GT(tunnels, 0) << "the plate is whole: take a thinner one";
  EXPECT_NE(said.find(fmt::format("{} tunnel", tunnels)), std::string::npos) << said;
}

}  // namespace
}  // namespace softreel
