/// Flips: other tetrahedra for the same room, when the worst of them is better than the worst before.
///
/// Freitag and Ollivier-Gooch, Tetrahedral Mesh Improvement Using Swapping and Smoothing, 1997; the best of all
/// tetrahedra round an edge by Klincsek, Minimal Triangulations of Polygonal Domains, 1980.
#pragma once

#include "core/tetmesh/improvement/tet_stars.h"

namespace softreel {

/// Larger rings than this are left alone: longer edges rarely give better elements, and the cost grows with the cube.
constexpr std::size_t kLargestRing = 7;

class Flips {
 public:
  /// tets: must outlive this.
  explicit Flips(TetStars& tets) : tets_(tets) {}

  /// Takes the edge from a to b away: the n elements round it become 2 (n - 2) without it, those of the ring's best
  /// triangulation (flips 3-2, 4-4, 5-6 ...). False, and nothing is changed, if the edge is on the boundary, if the
  /// ring has more than kLargestRing nodes, or if no choice is better.
  bool remove_edge(Index a, Index b);

  /// Takes the face of an element away that is opposite to its node `apex`: the two elements at it become three round
  /// a new edge (flip 2-3). False, and nothing is changed, if the face is on the boundary or if that is not better.
  bool remove_face(Index element, Index apex);

 private:
  void fill_table(Index a, Index b, double limit);
  void list_triangles(std::size_t first, std::size_t last, Index a, Index b);
  bool has_diagonal() const;
  double worst(std::span<const Index> elements) const;
  Index ring_node(std::size_t i) const { return ring_.nodes[i]; }

  /// Of the part of the ring between two of its nodes: the worst quality of the best choice, and the third corner of
  /// the triangle at the line between the two.
  struct Choice {
    double quality;
    std::size_t middle;
  };

  TetStars& tets_;
  EdgeRing ring_;
  std::array<std::array<Choice, kLargestRing>, kLargestRing> table_;
  std::vector<Tet> found_;
};

}  // namespace softreel
