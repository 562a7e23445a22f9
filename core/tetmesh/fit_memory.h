/// What an earlier fit of the boundary did, for the fit of a mesh that is the same in most places.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/tetmesh/boundary_stars.h"
#include "core/tetmesh/key_index.h"

namespace softreel {

/// A triangle of a tree or a boundary that is near a point, and the squared distance to it, m^2.
struct NearTriangle {
  Index number = -1;    ///< place in the tree, or number of the face; -1: none is known
  double squared = -1;  ///< -1: not measured since the point or the triangle moved
};

/// An earlier boundary and what was found out about it. Node, edge and face numbers are those of its BoundaryStars.
struct FitMemory {
  /// Where the fit of `stars` took the nodes that began at `before`. What else is known is to be filled in.
  FitMemory() = default;
  FitMemory(const BoundaryStars& stars, std::vector<Vec3> before, const std::vector<Vec3>& mesh_nodes);

  std::vector<Vec3> before, after;    ///< per node: where the fit found it and left it
  std::vector<std::uint8_t> settled;  ///< per node: nothing more to win, as long as nothing near it changes
  std::vector<std::array<Index, 2>> edges;
  std::vector<Triangle> faces;
  std::vector<NearTriangle> probes;   ///< nodes, edges and faces, in this order: the surface near them
  std::vector<NearTriangle> samples;  ///< per sample of the surface: the face near it

  /// The node that began at exactly `place`; -1 if none or several did.
  Index find(const Vec3& place) const;

 private:
  KeyIndex keys_;
  std::vector<Index> numbers_;  ///< per key
};

/// The same nodes, edges and faces in an earlier boundary and a new one that is not fitted yet.
struct Recollection {
  Recollection(const FitMemory& memory, const BoundaryStars& stars, const std::vector<Vec3>& mesh_nodes);

  std::vector<Index> nodes, edges, faces;  ///< per new one the number of the old one; -1: it is new
  std::vector<Index> new_faces;            ///< per old face
};

}  // namespace softreel
