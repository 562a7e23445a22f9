#include "core/elasticity/winding.h"

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/bcc_bar.h"
#include "tests/support/fan.h"

namespace softreel {
namespace {

ElasticBody make_body(const TetMesh& mesh) {
  return make_elastic_body(mesh, std::vector<ElementMaterial>(mesh.tets.size()), Dilatation::Linear);
}

std::vector<Index> all_elements(const ElasticBody& body) {
  std::vector<Index> elements(body.tets.size());
  for (std::size_t e = 0; e < elements.size(); ++e) elements[e] = static_cast<Index>(e);
  return elements;
}

std::vector<Vec3> scrambled(const ElasticBody& body, int seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < body.rest_positions.size(); ++i)
    positions.push_back({uniform(random), uniform(random), uniform(random)});
  return positions;
}

TEST(EdgeTurns, CountsTheWindingOfARing) {
  const TetMesh mesh = testing::fan_mesh(10);
  const ElasticBody body = make_body(mesh);
  for (const int factor : {1, 2, 3, -1, -2}) {
    EXPECT_NEAR(edge_turns(body, 0, 1, testing::wound_fan(mesh, factor)), factor, 1e-14);
    EXPECT_NEAR(edge_turns(body, 1, 0, testing::wound_fan(mesh, factor)), factor, 1e-14) << "from the other end";
  }
  EXPECT_GT(edge_turns(body, 0, 2, mesh.nodes), 0);
  EXPECT_LT(edge_turns(body, 0, 2, mesh.nodes), 0.5) << "a boundary edge, convex";
}

TEST(EdgeTurns, OfAnInteriorEdgeAreWholeForAnyPlacesOfTheNodes) {
  const TetMesh mesh = testing::kuhn_bar({3, 3, 3}, Vec3(1, 1, 1));
  const ElasticBody body = make_body(mesh);
  std::set<Index> boundary;
  for (const Triangle& face : boundary_faces(mesh)) boundary.insert(face.begin(), face.end());
  std::set<int> seen;
  for (int seed = 1; seed <= 20; ++seed) {
    const std::vector<Vec3> positions = scrambled(body, seed);
    for (const Tet& tet : mesh.tets)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
          if (i == j || boundary.count(tet[i]) > 0) continue;  // an end inside makes the edge interior
          const double turns = edge_turns(body, tet[i], tet[j], positions);
          EXPECT_NEAR(turns, std::round(turns), 1e-12);
          seen.insert(static_cast<int>(std::round(turns)));
        }
  }
  EXPECT_GE(seen.size(), 3U) << "scrambled nodes wind rings in several ways";
}

TEST(EdgeTurns, AreNoneForAnEdgeWithoutLength) {
  const TetMesh mesh = testing::fan_mesh(6);
  EXPECT_EQ(edge_turns(make_body(mesh), 0, 1, std::vector<Vec3>(mesh.nodes.size(), Vec3(1, 2, 3))), 0);
}

TEST(FindWoundElements, FindsARingWoundTwiceAlthoughNoneIsInverted) {
  const TetMesh mesh = testing::fan_mesh(10);
  const ElasticBody body = make_body(mesh);
  const std::vector<Vec3> twice = testing::wound_fan(mesh, 2);
  for (const Tet& tet : mesh.tets) {
    const TetNodes nodes = nodes_of(tet, twice);
    EXPECT_GT(tet_volume(nodes[0], nodes[1], nodes[2], nodes[3]), 0);
  }
  EXPECT_EQ(find_wound_elements(body, twice, all_elements(body)), all_elements(body));
  EXPECT_EQ(find_wound_elements(body, twice, std::vector<Index>{3}), all_elements(body)) << "one suspect of the ring";
  EXPECT_TRUE(find_wound_elements(body, twice, {}).empty());
  EXPECT_TRUE(find_wound_elements(body, mesh.nodes, all_elements(body)).empty());
  EXPECT_TRUE(find_wound_elements(body, testing::wound_fan(mesh, -1), all_elements(body)).empty())
      << "mirrored: inverted, but wound once";
}

TEST(FindWoundElements, LeavesABoundaryEdgeAloneHoweverItsFanIsSpread) {
  // Half of the fan, its angles stretched by four: two turns, but open.
  TetMesh mesh = testing::fan_mesh(12);
  mesh.tets.resize(6);
  const ElasticBody body = make_body(mesh);
  const std::vector<Vec3> spread = testing::wound_fan(mesh, 4);
  EXPECT_GT(edge_turns(body, 0, 1, spread), 1.5);
  EXPECT_TRUE(find_wound_elements(body, spread, all_elements(body)).empty());
}

}  // namespace
}  // namespace softreel
