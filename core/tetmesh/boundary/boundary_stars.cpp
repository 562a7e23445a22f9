#include "core/tetmesh/boundary/boundary_stars.h"

#include <algorithm>

#include "core/tetmesh/stuffing/boundary_mending.h"

namespace softreel {
namespace {

/// Per boundary node, the items whose nodes it is one of.
template <typename Item, typename NodesOf>
CompressedList list_owners(const BoundaryStars& stars, const std::vector<Item>& items, const NodesOf& nodes_of) {
  return CompressedList(stars.nodes.size(), [&](const auto& with) {
    for (std::size_t i = 0; i < items.size(); ++i)
      for (const Index node : nodes_of(items[i]))
        if (const Index b = stars.numbers[at(node)]; b >= 0) with(at(b), static_cast<Index>(i));
  });
}

}  // namespace

void CosineRange::add(const std::array<Vec3, 4>& x) {
  const Vec3 ab = x[1] - x[0], ac = x[2] - x[0], ad = x[3] - x[0], bc = x[2] - x[1], bd = x[3] - x[1];
  const Vec3 abc = ac.cross(ab);
  const std::array<Vec3, 4> normals{bc.cross(bd), ad.cross(ac), ab.cross(ad), abc};
  if (!(abc.dot(ad) < 0)) positive = false;
  std::array<double, 4> scales;
  for (std::size_t i = 0; i < 4; ++i) scales[i] = 1.0 / normals[i].norm();
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = -normals[i].dot(normals[j]) * scales[i] * scales[j];
      low = std::min(low, cosine);
      high = std::max(high, cosine);
    }
}

BoundaryStars::BoundaryStars(const StuffedMesh& stuffed)
    : faces(find_surface_faces(stuffed)), numbers(stuffed.mesh.nodes.size(), -1) {
  edges.reserve(3 * faces.size());
  for (const BoundaryFace& face : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = face.nodes[k], b = face.nodes[(k + 1) % 3];
      numbers[at(a)] = 0;
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  edges.shrink_to_fit();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] < 0) continue;
    numbers[i] = static_cast<Index>(nodes.size());
    nodes.push_back(static_cast<Index>(i));
  }
  elements_of = list_owners(*this, stuffed.mesh.tets, [](const Tet& tet) { return tet; });
  faces_of = list_owners(*this, faces, [](const BoundaryFace& face) { return face.nodes; });
  edges_of = list_owners(*this, edges, [](const std::array<Index, 2>& edge) { return edge; });
}

CosineRange BoundaryStars::cosines(const TetMesh& mesh, std::size_t b) const {
  CosineRange range;
  for (const Index e : elements_of.of(b)) {
    std::array<Vec3, 4> x;
    const Tet& tet = mesh.tets[at(e)];
    for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.nodes[at(tet[k])];
    range.add(x);
  }
  return range;
}

std::vector<std::array<Vec3, 3>> BoundaryStars::face_corners(const TetMesh& mesh) const {
  std::vector<std::array<Vec3, 3>> corners;
  corners.reserve(faces.size());
  for (const BoundaryFace& face : faces) {
    const auto [i, j, k] = face.nodes;
    corners.push_back({mesh.nodes[at(i)], mesh.nodes[at(j)], mesh.nodes[at(k)]});
  }
  return corners;
}

}  // namespace softreel
