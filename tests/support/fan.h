/// A closed ring of tetrahedra round one edge, and the same wound twice round it.
#pragma once

#include <cmath>

#include "core/tetmesh/tet_mesh.h"

namespace softreel::testing {

/// Nodes 0 and 1 are the ends of the edge, 0.1 m from its middle; the others a circle of radius 0.1 m about it.
inline TetMesh fan_mesh(Index count) {
  TetMesh mesh;
  mesh.lattice = {Vec3::Zero(), 0.2};
  mesh.nodes = {Vec3(0, 0, -0.1), Vec3(0, 0, 0.1)};
  for (Index k = 0; k < count; ++k) {
    const double angle = 2 * EIGEN_PI * k / count;
    mesh.nodes.push_back(0.1 * Vec3(std::cos(angle), std::sin(angle), 0));
    mesh.tets.push_back({0, 1, 2 + k, 2 + (k + 1) % count});
  }
  return mesh;
}

/// Every angle about the edge times `factor`: at 2 the ring is wound twice, and no tetrahedron is inverted from 5 on.
inline std::vector<Vec3> wound_fan(const TetMesh& mesh, int factor) {
  std::vector<Vec3> positions = mesh.nodes;
  for (std::size_t i = 2; i < positions.size(); ++i) {
    const double angle = factor * std::atan2(positions[i].y(), positions[i].x());
    positions[i] = 0.1 * Vec3(std::cos(angle), std::sin(angle), 0);
  }
  return positions;
}

}  // namespace softreel::testing
