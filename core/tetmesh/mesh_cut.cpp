#include "core/tetmesh/mesh_cut.h"

#include "core/base/check.h"

namespace softreel {
bool is_behind(const TetMesh& mesh, Index element, const CutPlane& plane) {
  double sum = 0;
  for (const Index node : mesh.tets[static_cast<std::size_t>(element)])
    sum += (mesh.nodes[static_cast<std::size_t>(node)] - plane.point).dot(plane.normal);
  return sum <= 0;
}

MeshCut cut_mesh(const TetMesh& mesh, const CutPlane& plane) {
  TetMesh part{mesh.nodes, {}, {}};
  std::vector<Index> element_of;  // per element of the part
  std::vector<char> kept(mesh.tets.size(), 0);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    if (!is_behind(mesh, static_cast<Index>(e), plane)) continue;
    kept[e] = 1;
    part.tets.push_back(mesh.tets[e]);
    element_of.push_back(static_cast<Index>(e));
  }
  std::vector<BoundaryFace> outer;
  for (const BoundaryFace& face : find_boundary(mesh))
    if (kept[static_cast<std::size_t>(face.element)] != 0) outer.push_back(face);
  // What bounds the whole bounds the part, too, and both lists are ordered alike: one runs along the other.
  MeshCut cut;
  cut.kept = static_cast<std::int64_t>(part.tets.size());
  auto next = outer.begin();
  for (const BoundaryFace& face : find_boundary(part)) {
    const Index element = element_of[static_cast<std::size_t>(face.element)];
    const bool is_outer = next != outer.end() && next->element == element && next->nodes == face.nodes;
    if (is_outer) ++next;
    cut.faces.push_back({face.nodes, element, is_outer});
  }
  CHECK(next == outer.end());
  return cut;
}

}  // namespace softreel
