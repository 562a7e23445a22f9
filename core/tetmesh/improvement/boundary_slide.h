/// Where nodes of the boundary may go: along the surface, as long as neither gets further from the other.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/tet_mesh.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

class BoundarySlide {
 public:
  /// nodes: of the mesh, must outlive this. faces: its boundary. surface: with triangles.
  ///
  /// Samples of the surface, a quarter as far apart as boundary nodes, belong to the face that is nearest.
  BoundarySlide(const std::vector<Vec3>& nodes, std::vector<Triangle> faces, const SurfaceMesh& surface,
                const Threads& threads);

  /// Of the boundary faces at a node, by area; unit length.
  Vec3 normal(Index node) const;

  /// Where a node goes that is to go to p: the nearest point of the surface, or p itself if the node is beside it.
  Vec3 place(Index node, const Vec3& p) const;

  /// How far the faces round a node and the samples of the surface that belong to them are apart, at most.
  struct Distances {
    double faces;            ///< of the faces from the surface, m
    double squared_samples;  ///< of the samples from the faces, m^2; less where it is nearly the largest of all
  };
  Distances distances(Index node) const;

  /// True if with the node at `to` neither is larger than `distances`. So nodes stay at corners, and go along creases
  /// at most.
  bool keeps(Index node, const Vec3& to, const Distances& distances) const;

  /// Says that a node has moved; its samples go to the faces that are nearest now.
  void moved(Index node);

 private:
  struct Sample {
    Vec3 point;
    double squared;  ///< distance to its face, or more
  };
  using Corners = std::array<Vec3, 3>;

  std::span<const Index> fan(Index node) const;
  Corners corners(Index face, Index moved_node, const Vec3& to) const;
  void list_fans();
  void assign_samples(const SurfaceMesh& surface, double step, const Threads& threads);
  void give_to_nearest(const Sample& sample, std::span<const Index> faces);

  const std::vector<Vec3>& nodes_;
  std::vector<Triangle> faces_;
  TriangleTree tree_;                           ///< of the surface
  std::vector<Index> fan_offsets_, fan_items_;  ///< boundary faces of each node
  std::vector<std::vector<Sample>> samples_;    ///< of the surface, per boundary face
  double nothing_ = 0, touching_ = 0;           ///< m: round-off, on the surface
  double smallest_ = 0, largest_ = 0;           ///< m: parts of faces not looked into, distance that samples stay below
};

}  // namespace softreel
