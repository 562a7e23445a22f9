#include "core/tetmesh/tet_mesh.h"

#include <algorithm>
#include <numeric>

namespace softreel {
namespace {

/// A face of an element: its sorted nodes, so that both owners have the same.
struct Face {
  Triangle sorted;
  Index element;
  Index local;
};

/// Local faces, counter-clockwise seen from outside; face k lies opposite node k.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaceNodes{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

Triangle face_nodes(const Tet& tet, Index local) {
  const auto& nodes = kFaceNodes[static_cast<std::size_t>(local)];
  return {tet[nodes[0]], tet[nodes[1]], tet[nodes[2]]};
}

/// All faces of all elements; equal faces are neighbours, ordered by element.
std::vector<Face> sorted_faces(const TetMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tets.size());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    for (Index local = 0; local < 4; ++local) {
      Triangle face = face_nodes(mesh.tets[e], local);
      std::sort(face.begin(), face.end());
      faces.push_back({face, static_cast<Index>(e), local});
    }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.element < b.element;
  });
  return faces;
}

Index find_root(std::vector<Index>& parent, Index i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    Index& up = parent[static_cast<std::size_t>(i)];
    up = parent[static_cast<std::size_t>(up)];
    i = up;
  }
  return i;
}

}  // namespace

std::vector<Triangle> boundary_faces(const TetMesh& mesh) {
  std::vector<Face> faces = sorted_faces(mesh);
  std::vector<std::pair<Index, Index>> single;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].sorted == faces[i].sorted) ++end;
    if (end == i + 1) single.emplace_back(faces[i].element, faces[i].local);
    i = end;
  }
  std::sort(single.begin(), single.end());
  std::vector<Triangle> boundary;
  boundary.reserve(single.size());
  for (const auto& [element, local] : single)
    boundary.push_back(face_nodes(mesh.tets[static_cast<std::size_t>(element)], local));
  return boundary;
}

std::vector<Index> face_connected_pieces(const TetMesh& mesh) {
  std::vector<Index> parent(mesh.tets.size());
  std::iota(parent.begin(), parent.end(), 0);
  const std::vector<Face> faces = sorted_faces(mesh);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].sorted != faces[i - 1].sorted) continue;
    const Index a = find_root(parent, faces[i].element), b = find_root(parent, faces[i - 1].element);
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  std::vector<Index> number(mesh.tets.size(), -1), piece(mesh.tets.size());
  Index count = 0;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    Index& name = number[static_cast<std::size_t>(find_root(parent, static_cast<Index>(e)))];
    if (name < 0) name = count++;
    piece[e] = name;
  }
  return piece;
}

}  // namespace softreel
