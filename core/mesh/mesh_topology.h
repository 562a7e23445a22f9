/// Edges and pieces of a triangle surface whose vertices were welded where they are exactly equal.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// One side of an edge: the triangle that has it, and whether that triangle runs from low to high.
struct HalfEdge {
  Index low, high;  ///< welded vertices, low < high
  Index triangle;
  bool forward;

  bool same_edge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

/// The triangles with each vertex replaced by the first one of its position. Vertices that are not finite stay apart.
std::vector<Triangle> welded_triangles(const SurfaceMesh& mesh);
/// The same with the result of weld_positions at hand.
std::vector<Triangle> welded_triangles(std::vector<Triangle> triangles, const std::vector<Index>& weld);

/// True if two corners are the same vertex, so that the triangle is a line or a point.
bool is_collapsed(const Triangle& welded);

/// The half edges of all triangles that are not collapsed, sorted by edge, then triangle; half edges of one edge are
/// neighbours. Cost: linear but for the sort within a vertex.
std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> welded);

/// Calls body(std::span<const HalfEdge>) for each edge, in the order of the half edges.
template <typename Body>
void for_each_edge(std::span<const HalfEdge> half_edges, const Body& body) {
  for (std::size_t begin = 0, end = 0; begin < half_edges.size(); begin = end) {
    while (end < half_edges.size() && half_edges[end].same_edge(half_edges[begin])) ++end;
    body(half_edges.subspan(begin, end - begin));
  }
}

/// Whether the triangles of an edge run along it as often in one direction as in the other; not at rims.
bool is_balanced(std::span<const HalfEdge> edge);

/// Number of the corner, three a triangle, at which a triangle has a vertex of its own.
inline Index corner_of(std::span<const Triangle> triangles, Index triangle, Index vertex) {
  const Triangle& corners = triangles[static_cast<std::size_t>(triangle)];
  return 3 * triangle + static_cast<Index>(std::find(corners.begin(), corners.end(), vertex) - corners.begin());
}

/// Six times the signed volume under triangle (a, b, c) as seen from the origin.
inline double signed_volume6(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a.dot(b.cross(c));
}

}  // namespace softreel
