/// Whether the boundary of a mesh is a manifold: what stuffing and embedding promise, looked at on every mesh they
/// make.
#pragma once

#include <span>

#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Where a boundary is no manifold. Both zero: every edge has two faces that run along it in opposite directions, and
/// the faces of every vertex form one fan.
struct BoundaryDefects {
  Index edges = 0;            ///< of one face, of more than two, or of two that run the same way
  Index vertices = 0;         ///< fans of faces beyond the first, over all vertices
  Vec3 first = Vec3::Zero();  ///< middle of the first bad edge, or the first bad vertex, m

  bool none() const { return edges == 0 && vertices == 0; }
};

/// faces: of find_boundary. Vertices are counted where all edges are sound. Cost: a sort of the edges.
BoundaryDefects check_boundary(const std::vector<Vec3>& nodes, std::span<const BoundaryFace> faces);

}  // namespace softreel
