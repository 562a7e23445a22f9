#include "core/tetmesh/tet_mesh.h"

#include <algorithm>

#include "core/mesh/disjoint_sets.h"

namespace softreel {
namespace {

/// Local faces, counter-clockwise seen from outside; face k lies opposite node k.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaceNodes{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

Triangle face_nodes(const Tet& tet, std::size_t local) {
  const auto& nodes = kFaceNodes[local];
  return {tet[nodes[0]], tet[nodes[1]], tet[nodes[2]]};
}

/// Face k of element e is number 4 e + k.
using FaceNumber = std::int64_t;

/// A face without its smallest node: both owners have the same two others.
struct Face {
  Index middle, largest;
  FaceNumber number;
};

/// Calls visit(smallest node, rest of the face) for all faces.
template <typename Visit>
void visit_faces(const TetMesh& mesh, const Visit& visit) {
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    for (std::size_t k = 0; k < 4; ++k) {
      Triangle face = face_nodes(mesh.tets[e], k);
      std::sort(face.begin(), face.end());
      visit(face[0], Face{face[1], face[2], static_cast<FaceNumber>(4 * e + k)});
    }
}

/// Calls visit(begin, end) for each run of equal faces, in a fixed order; a run lists its owners in ascending order.
/// Faces are bucketed by their smallest node, so that only a few dozen are ever sorted together.
template <typename Visit>
void visit_equal_faces(const TetMesh& mesh, const Visit& visit) {
  std::vector<std::int64_t> next(mesh.nodes.size() + 1, 0);
  visit_faces(mesh, [&](Index smallest, const Face&) { ++next[at(smallest) + 1]; });
  for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
  std::vector<Face> faces(4 * mesh.tets.size());
  visit_faces(mesh,
              [&](Index smallest, const Face& face) { faces[static_cast<std::size_t>(next[at(smallest)]++)] = face; });
  Face* begin = faces.data();
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    Face* const bucket_end = faces.data() + next[node];
    std::sort(begin, bucket_end, [](const Face& a, const Face& b) {
      if (a.middle != b.middle) return a.middle < b.middle;
      return a.largest != b.largest ? a.largest < b.largest : a.number < b.number;
    });
    while (begin < bucket_end) {
      Face* end = begin + 1;
      while (end < bucket_end && end->middle == begin->middle && end->largest == begin->largest) ++end;
      visit(begin, end);
      begin = end;
    }
  }
}

}  // namespace

std::vector<BoundaryFace> find_boundary(const TetMesh& mesh) {
  std::vector<FaceNumber> single;
  visit_equal_faces(mesh, [&](const Face* begin, const Face* end) {
    if (end == begin + 1) single.push_back(begin->number);
  });
  std::sort(single.begin(), single.end());
  std::vector<BoundaryFace> boundary;
  boundary.reserve(single.size());
  for (const FaceNumber number : single) {
    const auto element = static_cast<std::size_t>(number / 4);
    boundary.push_back(
        {face_nodes(mesh.tets[element], static_cast<std::size_t>(number % 4)), static_cast<Index>(element)});
  }
  return boundary;
}

std::vector<Triangle> boundary_faces(const TetMesh& mesh) {
  std::vector<Triangle> triangles;
  for (const BoundaryFace& face : find_boundary(mesh)) triangles.push_back(face.nodes);
  return triangles;
}

std::optional<std::array<Index, 2>> find_overlap_at_face(const TetMesh& mesh) {
  const auto element = [](const Face& face) { return static_cast<std::size_t>(face.number / 4); };
  // Seen from outside, the faces of elements on both sides of a face run in opposite directions.
  const auto second_node = [&](const Face& face) {
    const Triangle nodes = face_nodes(mesh.tets[element(face)], static_cast<std::size_t>(face.number % 4));
    const auto least = static_cast<std::size_t>(std::min_element(nodes.begin(), nodes.end()) - nodes.begin());
    return nodes[(least + 1) % 3];
  };
  const auto apex = [&](const Face& face) {
    return mesh.tets[element(face)][static_cast<std::size_t>(face.number % 4)];
  };
  std::optional<std::array<Index, 2>> overlap;
  visit_equal_faces(mesh, [&](const Face* begin, const Face* end) {
    for (const Face* a = begin; a < end; ++a)
      for (const Face* b = a + 1; b < end && !overlap; ++b) {
        const bool are_copies = apex(*a) != apex(*b) && mesh.nodes[at(apex(*a))] == mesh.nodes[at(apex(*b))];
        if (second_node(*a) == second_node(*b) && !are_copies)
          overlap = {static_cast<Index>(element(*a)), static_cast<Index>(element(*b))};
      }
  });
  return overlap;
}

std::vector<Index> face_connected_pieces(const TetMesh& mesh) {
  DisjointSets sets(mesh.tets.size());
  visit_equal_faces(mesh, [&](const Face* begin, const Face* end) {
    for (const Face* face = begin + 1; face < end; ++face)
      sets.join(static_cast<Index>(begin->number / 4), static_cast<Index>(face->number / 4));
  });
  std::vector<Index> piece(mesh.tets.size());
  Index count = 0;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const Index root = sets.root(static_cast<Index>(e));
    piece[e] = at(root) == e ? count++ : piece[at(root)];  // a root is the first of its piece
  }
  return piece;
}

}  // namespace softreel
