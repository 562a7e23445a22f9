/// Boxes of tetrahedra for tests: whole BCC lattice tetrahedra, and cubes cut in six (Kuhn).
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "core/skinning/embedding.h"
#include "core/tetmesh/lattice/bcc_lattice.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel::testing {

/// Gives the tetrahedron the project's orientation.
inline Tet oriented(Tet tet, const std::vector<Vec3>& nodes) {
  const auto at = [&](std::size_t k) { return nodes[static_cast<std::size_t>(tet[k])]; };
  if (tet_volume(at(0), at(1), at(2), at(3)) < 0) std::swap(tet[2], tet[3]);
  return tet;
}

/// All tetrahedra of the BCC lattice whose two cube centres lie among cells[0] x cells[1] x cells[2] cubes of edge
/// `spacing`, the first at the origin: the box without its outermost half tetrahedra (its faces are not flat).
inline TetMesh bcc_bar(const std::array<int, 3>& cells, double spacing) {
  TetMesh mesh;
  mesh.lattice = {Vec3::Zero(), spacing};
  std::map<LatticeNode, Index> indices;
  const auto node = [&](const LatticeNode& lattice_node) {
    const auto [at, added] = indices.emplace(lattice_node, static_cast<Index>(mesh.nodes.size()));
    if (added) mesh.nodes.push_back(lattice_position(mesh.lattice, lattice_node));
    return at->second;
  };
  const auto add_square = [&](const LatticeNode& center, std::size_t c) {
    LatticeNode next = center;
    next[c] += 2;
    const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
    const std::array<std::array<int, 2>, 4> corners{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<LatticeNode, 2> edge{center, center};
      for (std::size_t end = 0; end < 2; ++end) {
        edge[end][c] += 1;
        edge[end][a] += corners[(k + end) % 4][0];
        edge[end][b] += corners[(k + end) % 4][1];
      }
      const Tet tet{node(center), node(next), node(edge[0]), node(edge[1])};
      mesh.tets.push_back(oriented(tet, mesh.nodes));
    }
  };
  for (int z = 0; z < cells[2]; ++z)
    for (int y = 0; y < cells[1]; ++y)
      for (int x = 0; x < cells[0]; ++x) {
        const std::array<int, 3> cell{x, y, z};
        for (std::size_t c = 0; c < 3; ++c)
          if (cell[c] + 1 < cells[c]) add_square({2 * x + 1, 2 * y + 1, 2 * z + 1}, c);
      }
  return mesh;
}

/// A box [0, size] of cells cut in six tetrahedra along their main diagonal. The lattice is that of the largest cell.
inline TetMesh kuhn_bar(const std::array<int, 3>& cells, const Vec3& size) {
  TetMesh mesh;
  const Vec3 cell(size.x() / cells[0], size.y() / cells[1], size.z() / cells[2]);
  mesh.lattice = {Vec3::Zero(), cell.maxCoeff()};
  const auto index = [&](const std::array<int, 3>& n) {
    return static_cast<Index>(n[0] + (cells[0] + 1) * (n[1] + (cells[1] + 1) * n[2]));
  };
  for (int z = 0; z <= cells[2]; ++z)
    for (int y = 0; y <= cells[1]; ++y)
      for (int x = 0; x <= cells[0]; ++x) mesh.nodes.push_back(cell.cwiseProduct(Vec3(x, y, z)));
  constexpr std::array<std::array<std::size_t, 3>, 6> kOrders{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int z = 0; z < cells[2]; ++z)
    for (int y = 0; y < cells[1]; ++y)
      for (int x = 0; x < cells[0]; ++x)
        for (const auto& order : kOrders) {
          std::array<int, 3> corner{x, y, z};
          Tet tet{index(corner), 0, 0, 0};
          for (std::size_t k = 0; k < 3; ++k) {
            ++corner[order[k]];
            tet[k + 1] = index(corner);
          }
          mesh.tets.push_back(oriented(tet, mesh.nodes));
        }
  return mesh;
}

/// One mesh of two, the second moved by `shift`; they share no node.
inline TetMesh side_by_side(const TetMesh& first, const TetMesh& second, const Vec3& shift) {
  TetMesh both = first;
  const auto more = static_cast<Index>(first.nodes.size());
  for (const Vec3& node : second.nodes) both.nodes.push_back(node + shift);
  for (const Tet& tet : second.tets) both.tets.push_back({tet[0] + more, tet[1] + more, tet[2] + more, tet[3] + more});
  return both;
}

/// Each node as a surface point: weight 1 on that node, in the first element that has it. Such a point's pin holds the
/// whole element.
inline Embedding embed_nodes(const TetMesh& mesh) {
  Embedding embedding;
  embedding.elements.assign(mesh.nodes.size(), -1);
  embedding.weights.assign(mesh.nodes.size(), {0, 0, 0, 0});
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = static_cast<std::size_t>(mesh.tets[e][k]);
      if (embedding.elements[node] >= 0) continue;
      embedding.elements[node] = static_cast<Index>(e);
      embedding.weights[node][k] = 1;
    }
  return embedding;
}

/// Centre of an element at rest.
inline Vec3 centroid(const TetMesh& mesh, std::size_t e) {
  Vec3 sum = Vec3::Zero();
  for (const Index node : mesh.tets[e]) sum += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
  return sum;
}

/// Nodes for which `takes` is true, in order.
template <typename Predicate>
std::vector<Index> select_nodes(const TetMesh& mesh, const Predicate& takes) {
  std::vector<Index> nodes;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (takes(mesh.nodes[i])) nodes.push_back(static_cast<Index>(i));
  return nodes;
}

}  // namespace softreel::testing
