/// What every tetrahedral mesh must satisfy, for tests.
#pragma once

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/tetmesh/quality/tet_quality.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel::test {

/// Positive volumes, dihedral angles within the promised bounds.
inline void expect_good_tets(const TetMesh& mesh) {
  const TetQuality quality = measure_quality(mesh, Threads(1));
  EXPECT_GT(quality.min_volume, 0);
  EXPECT_GE(quality.min_dihedral, kMinDihedral);
  EXPECT_LE(quality.max_dihedral, kMaxDihedral);
}

/// Every edge has two boundary faces of opposite directions, the faces of every vertex form one fan.
inline void expect_manifold_boundary(const TetMesh& mesh) {
  std::map<std::pair<Index, Index>, int> directed;
  std::map<Index, std::map<Index, Index>> next_around;
  for (const Triangle& face : boundary_faces(mesh))
    for (std::size_t k = 0; k < 3; ++k) {
      ++directed[{face[k], face[(k + 1) % 3]}];
      next_around[face[k]][face[(k + 1) % 3]] = face[(k + 2) % 3];
    }
  for (const auto& [edge, count] : directed) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(directed.contains({edge.second, edge.first}));
  }
  for (const auto& [vertex, next] : next_around) {
    std::size_t steps = 0;
    Index at = next.begin()->first;
    do {
      at = next.at(at);
      ++steps;
    } while (at != next.begin()->first && steps <= next.size());
    ASSERT_EQ(steps, next.size()) << "boundary faces of node " << vertex << " form more than one fan";
  }
}

/// V - E + F of the boundary.
inline int euler_characteristic(const TetMesh& mesh) {
  std::set<Index> vertices;
  const std::vector<Triangle> faces = boundary_faces(mesh);
  for (const Triangle& face : faces) vertices.insert(face.begin(), face.end());
  return static_cast<int>(vertices.size()) - static_cast<int>(faces.size() / 2);  // closed: E = 3 F / 2
}

inline int count_pieces(const TetMesh& mesh) {
  const std::vector<Index> piece = face_connected_pieces(mesh);
  return piece.empty() ? 0 : *std::max_element(piece.begin(), piece.end()) + 1;
}

}  // namespace softreel::test
