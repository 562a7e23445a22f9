/// Tetrahedra that can be exchanged for others, with the elements round each node and the quality of each element.
#pragma once

#include <span>
#include <vector>

#include "core/tetmesh/improvement/angle_measure.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// The elements round an edge: element i has the nodes a, b, ring[i] and ring[i + 1], positively oriented, so that the
/// ring goes counter-clockwise seen from b.
struct EdgeRing {
  std::vector<Index> elements, nodes;
  bool closed = false;  ///< the edge is inside, and its elements go round it once
};

/// Works on a mesh in place. Elements that were taken away leave a gap until `compact`.
class TetStars {
 public:
  /// measure: must outlive this, and have admitted what it is to admit before elements are judged by it.
  TetStars(TetMesh& mesh, const AngleMeasure& measure);

  const AngleMeasure& measure() const { return measure_; }
  std::size_t slots() const { return mesh_.tets.size(); }
  bool is_gap(Index element) const { return tet(element)[0] < 0; }
  const Tet& tet(Index element) const { return mesh_.tets[static_cast<std::size_t>(element)]; }
  double quality(Index element) const { return qualities_[static_cast<std::size_t>(element)]; }
  const Vec3& position(Index node) const { return mesh_.nodes[static_cast<std::size_t>(node)]; }
  const std::vector<Vec3>& nodes() const { return mesh_.nodes; }
  std::span<const Index> star(Index node) const { return stars_[static_cast<std::size_t>(node)]; }
  TetCorners corners(Index element) const;
  TetCorners corners(const Tet& tet) const;

  /// The elements round the edge from a to b, starting with any.
  void find_ring(Index a, Index b, EdgeRing& ring) const;

  /// The other element of a face of three nodes, -1 if there is none; -2 if there are several.
  Index across(const Triangle& face, Index element) const;

  bool has_edge(Index a, Index b) const;

  void move(Index node, const Vec3& to);

  /// Takes elements away and puts others in.
  void exchange(std::span<const Index> old_elements, std::span<const Tet> new_tets);

  /// Number of the last change that touched an element of a node; grows with each change.
  std::int64_t last_change(Index node) const { return changes_[static_cast<std::size_t>(node)]; }
  std::int64_t now() const { return now_; }

  /// Closes the gaps; the others keep their order.
  void compact();

 private:
  void insert(Index slot, const Tet& tet);

  TetMesh& mesh_;
  const AngleMeasure& measure_;
  std::vector<std::vector<Index>> stars_;
  std::vector<double> qualities_;
  std::vector<Index> gaps_;
  std::vector<std::int64_t> changes_;
  std::int64_t now_ = 0;
};

}  // namespace softreel
