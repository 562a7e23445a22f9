/// Points all over a boundary - its nodes, the middles of its edges and of its faces - and the surface near them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/parallel.h"
#include "core/tetmesh/boundary_stars.h"
#include "core/tetmesh/fit_memory.h"
#include "core/tetmesh/tet_mesh.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

/// Numbers of probes: nodes first, then edges, then faces. All arguments are borrowed.
class BoundaryProbes {
 public:
  /// near: squared, m^2; of triangles of the tree nearer than that any will do.
  BoundaryProbes(const TriangleTree& tree, const BoundaryStars& stars, const TetMesh& mesh, double near);

  /// Takes over what an earlier fit found at the same nodes, edges and faces. It stands for those that do not move.
  void recall(const FitMemory& memory, const Recollection& known);
  /// Nearest triangles of the nodes that nothing is known of; guesses, from them, for edges and faces.
  void find_at_nodes(const Threads& threads);
  /// Finds the triangles near the probes again that moved, or were not measured yet. moved: per boundary node.
  void update(const std::vector<std::uint8_t>& moved, const Threads& threads);

  const std::vector<NearTriangle>& near_triangles() const { return near_triangles_; }
  const NearTriangle& operator[](std::size_t probe) const { return near_triangles_[probe]; }
  Vec3 point(std::size_t probe) const;
  /// The point of the surface near a probe, in the triangle known for it.
  Vec3 foot(std::size_t probe) const;
  /// The triangle near a probe where it is now; begins with the one known for it.
  NearTriangle measure(std::size_t probe) const;

  std::size_t of_edge(std::size_t edge) const { return stars_.nodes.size() + edge; }
  std::size_t of_face(std::size_t face) const { return stars_.nodes.size() + stars_.edges.size() + face; }

  /// Calls visit(probe, share of the node in it) for the probes that move with boundary node `b`.
  template <typename Visit>
  void visit_probes(std::size_t b, const Visit& visit) const {
    visit(b, 1.0);
    for (const Index e : stars_.edges_of.of(b)) visit(of_edge(static_cast<std::size_t>(e)), 0.5);
    for (const Index f : stars_.faces_of.of(b)) visit(of_face(static_cast<std::size_t>(f)), 1.0 / 3);
  }

 private:
  bool has_moved(std::size_t probe, const std::vector<std::uint8_t>& moved) const;

  const TriangleTree& tree_;
  const BoundaryStars& stars_;
  const TetMesh& mesh_;
  double near_;
  std::vector<NearTriangle> near_triangles_;  ///< numbers: places in the tree
};

}  // namespace softreel
