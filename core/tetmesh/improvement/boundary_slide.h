/// Where nodes of the boundary may go: along the surface, as long as neither gets further from the other.
#pragma once

#include <cstdint>
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
  /// Samples of the surface, half as far apart as boundary nodes, belong to the face that is nearest. good_share: of
  /// the largest distance of the mesh so far; what is nearer than that counts as good.
  BoundarySlide(const std::vector<Vec3>& nodes, std::vector<Triangle> faces, const SurfaceMesh& surface,
                double good_share, const Threads& threads);

  /// Of the boundary faces at a node, by area; unit length.
  Vec3 normal(Index node) const;

  /// Where a node goes that is to go to p: the nearest point of the surface, or p itself if the node is beside it.
  Vec3 place(Index node, const Vec3& p) const;

  /// True if, with the node at `to`, the faces round it are no further from the surface than the farthest of them was,
  /// and the samples of the surface that belong to them no further from these faces; or where both are good. What is
  /// good counts for smooth places only: at creases and corners nothing at all may get further. Nor may anything get
  /// near the largest distance of the mesh.
  bool keeps_distance(Index node, const Vec3& to) const;

  /// Says that a node has moved; its samples go to the faces that are nearest now.
  void moved(Index node);

 private:
  enum class Freedom : std::uint8_t { Inside, Smooth, Crease, Beside };
  struct Sample {
    Vec3 point;
    double squared;  ///< distance to its face, or more
  };
  using Corners = std::array<Vec3, 3>;

  std::span<const Index> fan(Index node) const;
  Corners corners(Index face, Index moved_node, const Vec3& to) const;
  void list_fans();
  void assign_samples(const SurfaceMesh& surface, double step, const Threads& threads);
  void find_freedom();
  void give_to_nearest(const Sample& sample, std::span<const Index> faces);
  bool keeps_samples(Index node, const Vec3& to, double good) const;
  bool keeps_faces(Index node, const Vec3& to, double good) const;
  double face_error(const Corners& x, double enough) const;
  double fan_error(Index node, const Vec3& at_node, double enough) const;
  double farthest_face(const Threads& threads) const;
  double mean_edge() const;

  const std::vector<Vec3>& nodes_;
  std::vector<Triangle> faces_;
  TriangleTree tree_;                           ///< of the surface
  std::vector<Index> fan_offsets_, fan_items_;  ///< boundary faces of each node
  std::vector<Freedom> freedom_;                ///< per node
  std::vector<std::vector<Sample>> samples_;    ///< of the surface, per boundary face
  double nothing_ = 0, good_ = 0, bad_ = 0;     ///< squared distances: round-off, good, nearly the largest
};

}  // namespace softreel
