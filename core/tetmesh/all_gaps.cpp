#include "core/tetmesh/all_gaps.h"

#include "core/tetmesh/boundary_mending.h"
#include "core/tetmesh/farthest_point.h"

namespace softreel {

std::vector<BoundaryGap> find_all_gaps(const StuffedMesh& stuffed, const SurfaceMesh& visible, const TriangleTree& tree,
                                       const HoleCaps& caps, double limit, const Threads& threads) {
  const std::vector<Vec3>& nodes = stuffed.mesh.nodes;
  std::vector<Triangle> faces;
  for (const BoundaryFace& face : find_surface_faces(stuffed)) faces.push_back(face.nodes);
  const TriangleTree boundary(nodes, faces);
  std::vector<BoundaryGap> gaps;
  for (const Vec3& p : find_far_points(visible.positions, visible.triangles, boundary, limit, threads)) {
    const TriangleTree::Nearest found = boundary.nearest(p);
    gaps.push_back({p, found.point, faces[static_cast<std::size_t>(found.triangle)]});
  }
  const auto add_from_boundary = [&](const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
    for (const Vec3& p : find_far_points(points, triangles, tree, limit, threads))
      gaps.push_back({tree.nearest(p).point, p, faces[static_cast<std::size_t>(boundary.nearest(p).triangle)], true});
  };
  if (caps.any()) {
    const SurfaceMesh followed = caps.without_caps(nodes, faces, limit, threads);
    add_from_boundary(followed.positions, followed.triangles);
  } else {
    add_from_boundary(nodes, faces);
  }
  return gaps;
}

}  // namespace softreel
