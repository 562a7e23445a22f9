/// Moves a node to where the worst of the elements round it is best.
///
/// The worst quality is a minimum of smooth functions: its ascent goes along the shortest vector of the convex hull of
/// the gradients of those that are nearly the worst (Freitag and Ollivier-Gooch, Tetrahedral Mesh Improvement Using
/// Swapping and Smoothing, 1997; Gilbert, An Iterative Procedure for Computing the Minimum of a Quadratic Form on a
/// Convex Set, 1966).
#pragma once

#include <optional>

#include "core/tetmesh/improvement/boundary_slide.h"
#include "core/tetmesh/improvement/tet_stars.h"

namespace softreel {

class NodeSmoothing {
 public:
  /// tets, slide: must outlive this. slide: null if nodes of the boundary stay.
  NodeSmoothing(TetStars& tets, BoundarySlide* slide, const std::vector<bool>& on_boundary)
      : tets_(tets), slide_(slide), on_boundary_(on_boundary) {}

  /// True if the node was moved, which made the worst element round it worthwhile() better at least. Inner nodes go
  /// anywhere, nodes of the boundary along the surface as BoundarySlide allows.
  bool improve(Index node);

 private:
  void gather(Index node);
  double quality_at(const Vec3& x, double limit);
  void find_gradients(const Vec3& x, double limit);
  Vec3 direction(const Vec3& x, double quality);
  bool step(Vec3& x, double& quality);
  Vec3 placed(const Vec3& x) const;
  const BoundarySlide::Distances& distances();
  double shortest_edge(const Vec3& x) const;

  TetStars& tets_;
  BoundarySlide* slide_;
  const std::vector<bool>& on_boundary_;
  Index node_ = -1;
  bool slides_ = false;
  Vec3 normal_ = Vec3::Zero();  ///< of the boundary at a node that slides
  std::optional<BoundarySlide::Distances> distances_;
  std::vector<std::array<Vec3, 3>> opposite_;  ///< of each element of the star the face opposite to the node
  std::vector<Vec3> gradients_;                ///< of what is nearly the worst
};

}  // namespace softreel
