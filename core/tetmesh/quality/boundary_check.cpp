#include "core/tetmesh/quality/boundary_check.h"

#include <algorithm>
#include <vector>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/mesh_topology.h"

namespace softreel {
namespace {

/// Joins the corners of triangles that belong to one fan; says where edges forbid that.
BoundaryDefects join_fans(const std::vector<Vec3>& nodes, std::span<const Triangle> triangles, DisjointSets& corners) {
  BoundaryDefects defects;
  const std::vector<HalfEdge> sides = sorted_half_edges(triangles);
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    if (edge.size() == 2 && edge[0].forward != edge[1].forward) {
      for (const Index node : {edge[0].low, edge[0].high})
        corners.join(corner_of(triangles, edge[0].triangle, node), corner_of(triangles, edge[1].triangle, node));
    } else if (defects.edges++ == 0) {
      defects.first = 0.5 * (nodes[at(edge[0].low)] + nodes[at(edge[0].high)]);
    }
  });
  return defects;
}

}  // namespace

BoundaryDefects check_boundary(const std::vector<Vec3>& nodes, std::span<const BoundaryFace> faces) {
  std::vector<Triangle> triangles;
  triangles.reserve(faces.size());
  for (const BoundaryFace& face : faces) triangles.push_back(face.nodes);
  DisjointSets corners(3 * faces.size());
  BoundaryDefects defects = join_fans(nodes, triangles, corners);
  if (defects.edges > 0) return defects;
  std::vector<Index> fan(nodes.size(), -1);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = static_cast<Index>(3 * f + k);
      if (corners.root(corner) != corner) continue;  // one corner speaks for its fan
      const Index node = triangles[f][k];
      if (fan[at(node)] >= 0 && defects.vertices++ == 0) defects.first = nodes[at(node)];
      fan[at(node)] = corner;
    }
  return defects;
}

}  // namespace softreel
