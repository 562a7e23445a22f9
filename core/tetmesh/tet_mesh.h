/// Linear tetrahedra that fill a body: nodes, elements, the lattice they were cut from, and their boundary.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Where the body-centred cubic lattice of a mesh lies (core/tetmesh/lattice/bcc_lattice.h).
struct LatticeFrame {
  Vec3 origin = Vec3::Zero();  ///< position of lattice node (0, 0, 0), m
  double spacing = 0;          ///< cubic cell size = long edge, m; 0: the mesh was cut from no lattice
};

/// A tetrahedral mesh. det[X1-X0, X2-X0, X3-X0] > 0 for every element.
struct TetMesh {
  std::vector<Vec3> nodes;        ///< rest positions X, nodes x 3, m
  std::vector<Tet> tets;          ///< elements x 4
  LatticeFrame lattice;           ///< nested lattices of the multigrid hierarchy start from this one
  std::vector<double> fill = {};  ///< per element: share of its volume that is material, above 0, up to 1; empty: all
  /// Per vertex of the surface it was made from: the element that carries it, -1: the one found by place; empty: all
  /// are found by place. Where elements overlap, place alone does not say which part a point belongs to.
  std::vector<Index> carriers = {};
  /// Per node: spacing of the lattice around it, m, where bodies of different lattices are joined to one mesh; empty:
  /// that of `lattice`.
  std::vector<double> spacings = {};

  /// Share of element e that is material.
  double fill_of(std::size_t e) const { return fill.empty() ? 1.0 : fill[e]; }
};

/// Signed volume of a tetrahedron, m^3; positive for the project's orientation.
inline double tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6.0;
}

/// A face that belongs to one element only.
struct BoundaryFace {
  Triangle nodes;  ///< counter-clockwise seen from outside
  Index element;
};

/// Faces that belong to one element only, ordered by element and local face. Linear time.
std::vector<BoundaryFace> find_boundary(const TetMesh& mesh);

/// Their nodes alone, in the same order.
std::vector<Triangle> boundary_faces(const TetMesh& mesh);

/// Number of the piece of each element; elements that share a face are in one piece. Pieces are numbered from 0 in the
/// order of their first element.
std::vector<Index> face_connected_pieces(const TetMesh& mesh);

/// The first two elements found that lie on one side of a face that they share; so do two of any three at one face.
/// Copies of one element that differ in their fourth nodes' numbers, not places, do not count: embedded meshes have
/// them. Elements have positive volumes.
std::optional<std::array<Index, 2>> find_overlap_at_face(const TetMesh& mesh);

}  // namespace softreel
