#include "core/tetmesh/graded/filled_surface.h"

#include <algorithm>
#include <numeric>

#include "core/tetmesh/farthest_point.h"
#include "core/tetmesh/stuffing/boundary_mending.h"
#include "core/tetmesh/stuffing/mesh_pieces.h"
#include "core/tetmesh/surface/hidden_surface.h"

namespace softreel {
namespace {

SurfaceMesh bare(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  SurfaceMesh mesh;
  mesh.positions = positions;
  mesh.triangles = triangles;
  return mesh;
}

}  // namespace

FilledSurface::FilledSurface(const SurfaceMesh& mesh)
    : surface_(mesh),
      sampler_(mesh.positions, mesh.triangles),
      caps_(mesh.positions, mesh.triangles, sampler_.tree()),
      box_(used_bounds(mesh)) {}

double FilledSurface::area() const {
  double area = 0;
  for (const auto& [a, b, c] : surface_.triangles)
    area += 0.5 * (surface_.positions[at(b)] - surface_.positions[at(a)])
                      .cross(surface_.positions[at(c)] - surface_.positions[at(a)])
                      .norm();
  return area;
}

SurfaceMesh FilledSurface::visible(double error, const Threads& threads) const {
  if (sampler_.near_overlaps().empty()) return bare(surface_.positions, surface_.triangles);
  return without_hidden(surface_, sampler_.near_overlaps(), error, threads);
}

SurfaceSamples FilledSurface::sample(const SurfaceMesh& visible, double step) const {
  // In the order of the tree; triangles that are not in it as they come.
  if (visible.triangles.size() == tree().order().size()) return {visible, tree().order(), step, SurfaceSamples::kOnce};
  std::vector<Index> order(visible.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  return {visible, order, step, SurfaceSamples::kOnce};
}

void FilledSurface::leave_out_caps(std::vector<BoundaryGap>& gaps) const {
  if (!caps_.any()) return;
  std::erase_if(gaps, [&](const BoundaryGap& gap) { return gap.from_boundary && caps_.contain(gap.on_boundary); });
}

SurfaceMesh FilledSurface::without_caps(const std::vector<Vec3>& nodes, const std::vector<Triangle>& faces,
                                        double limit, const Threads& threads) const {
  return caps_.any() ? caps_.without_caps(nodes, faces, limit, threads) : bare(nodes, faces);
}

std::vector<BoundaryGap> FilledSurface::find_gaps(const StuffedMesh& stuffed, const SurfaceMesh& visible, double limit,
                                                  const Threads& threads) const {
  std::vector<Triangle> faces;
  for (const BoundaryFace& face : find_surface_faces(stuffed)) faces.push_back(face.nodes);
  const TriangleTree boundary(stuffed.mesh.nodes, faces);
  std::vector<BoundaryGap> gaps;
  for (const Vec3& p : find_far_points(visible.positions, visible.triangles, boundary, limit, threads)) {
    const TriangleTree::Nearest found = boundary.nearest(p);
    gaps.push_back({p, found.point, faces[at(found.triangle)]});
  }
  const SurfaceMesh followed = without_caps(stuffed.mesh.nodes, faces, limit, threads);
  for (const Vec3& p : find_far_points(followed.positions, followed.triangles, tree(), limit, threads))
    gaps.push_back({tree().nearest(p).point, p, faces[at(boundary.nearest(p).triangle)], true});
  return gaps;
}

std::vector<BoundaryGap> FilledSurface::find_loose_pieces(const StuffedMesh& stuffed,
                                                          const std::vector<Index>& nearest_triangles,
                                                          const LooseRule& rule) const {
  const TetMesh& mesh = stuffed.mesh;
  const std::vector<Index> pieces = face_connected_pieces(mesh);
  if (pieces.empty()) return {};
  std::vector<Index> counts(at(*std::max_element(pieces.begin(), pieces.end()) + 1), 0);
  for (const Index piece : pieces) ++counts[at(piece)];
  if (counts.size() == 1) return {};
  const std::vector<bool> is_main = find_main_pieces(stuffed, nearest_triangles, pieces, rule.triangle_solids);
  std::vector<BoundaryGap> gaps;
  for (const BoundaryFace& face : find_surface_faces(stuffed)) {
    const std::size_t piece = at(pieces[at(face.element)]);
    if (is_main[piece] || counts[piece] > rule.most_share * static_cast<double>(pieces.size())) continue;
    const Vec3& p = mesh.nodes[at(face.nodes[0])];
    gaps.push_back({tree().nearest(p).point, p, face.nodes});
  }
  return gaps;
}

}  // namespace softreel
