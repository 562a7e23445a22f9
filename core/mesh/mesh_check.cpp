#include "core/mesh/mesh_check.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/mesh/mesh_topology.h"

namespace softreel {
namespace {

void count_vertices(const SurfaceMesh& mesh, const std::vector<Triangle>& welded, MeshFacts& facts) {
  std::vector<char> used(mesh.positions.size(), 0), distinct(mesh.positions.size(), 0);
  DisjointSets sets(mesh.positions.size());
  for (std::size_t t = 0; t < welded.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      used[static_cast<std::size_t>(mesh.triangles[t][k])] = 1;
      distinct[static_cast<std::size_t>(welded[t][k])] = 1;
      sets.join(welded[t][0], welded[t][k]);
    }
  facts.vertices = static_cast<std::int64_t>(mesh.positions.size());
  facts.used_vertices = std::count(used.begin(), used.end(), 1);
  facts.distinct_vertices = std::count(distinct.begin(), distinct.end(), 1);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (distinct[v] != 0 && sets.root(static_cast<Index>(v)) == static_cast<Index>(v)) ++facts.pieces;
    if (!mesh.positions[v].allFinite()) ++facts.not_finite;
  }
}

void count_triangles(const SurfaceMesh& mesh, const std::vector<Triangle>& welded, MeshFacts& facts) {
  facts.triangles = static_cast<std::int64_t>(welded.size());
  const Vec3 center = facts.bounds.center();
  std::vector<Triangle> sorted;
  for (const Triangle& triangle : welded) {
    if (is_collapsed(triangle)) {
      ++facts.collapsed_triangles;
      continue;
    }
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.positions[static_cast<std::size_t>(triangle[k])] - center;
    if ((p[1] - p[0]).cross(p[2] - p[0]).isZero(0)) ++facts.flat_triangles;
    facts.signed_volume += signed_volume6(p[0], p[1], p[2]) / 6;
    sorted.push_back(triangle);
    std::sort(sorted.back().begin(), sorted.back().end());
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t t = 1; t < sorted.size(); ++t)
    if (sorted[t] == sorted[t - 1]) ++facts.duplicate_triangles;
}

/// Number of closed chains of boundary edges. Two boundary edges that meet in a vertex follow each other if a fan of
/// triangles round that vertex joins them, so that two holes which touch in a vertex stay two.
std::int64_t count_holes(std::span<const HalfEdge> sides, std::size_t triangles) {
  std::vector<std::array<Index, 3>> edges_of(triangles, {-1, -1, -1});
  std::vector<HalfEdge> edges;  // one representative each
  std::vector<Index> boundary;
  for_each_edge(sides, [&](std::span<const HalfEdge> edge) {
    const auto e = static_cast<Index>(edges.size());
    for (const HalfEdge& side : edge) {
      std::array<Index, 3>& slots = edges_of[static_cast<std::size_t>(side.triangle)];
      *std::find(slots.begin(), slots.end(), -1) = e;
    }
    if (edge.size() == 1) boundary.push_back(e);
    edges.push_back(edge.front());
  });
  DisjointSets ends(2 * edges.size());  // end 2 e: edge e at its low vertex; 2 e + 1: at its high vertex
  const auto end_at = [&](Index e, Index v) { return 2 * e + (edges[static_cast<std::size_t>(e)].low == v ? 0 : 1); };
  for (const std::array<Index, 3>& own : edges_of) {
    if (own[0] < 0) continue;  // collapsed
    for (std::size_t k = 0; k < 3; ++k) {
      const HalfEdge &a = edges[static_cast<std::size_t>(own[k])],
                     &b = edges[static_cast<std::size_t>(own[(k + 1) % 3])];
      const Index shared = a.low == b.low || a.low == b.high ? a.low : a.high;
      ends.join(end_at(own[k], shared), end_at(own[(k + 1) % 3], shared));
    }
  }
  for (const Index e : boundary) ends.join(2 * e, 2 * e + 1);
  std::vector<Index> roots;
  for (const Index e : boundary) roots.push_back(ends.root(2 * e));
  std::sort(roots.begin(), roots.end());
  return std::unique(roots.begin(), roots.end()) - roots.begin();
}

std::string how_many(std::int64_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

}  // namespace

MeshFacts check_mesh(const SurfaceMesh& mesh) {
  MeshFacts facts;
  facts.bounds = used_bounds(mesh);
  const std::vector<Triangle> welded = welded_triangles(mesh);
  count_vertices(mesh, welded, facts);
  count_triangles(mesh, welded, facts);
  const std::vector<HalfEdge> sides = sorted_half_edges(welded);
  for_each_edge(sides, [&](std::span<const HalfEdge> edge) {
    ++facts.edges;
    if (edge.size() == 1) ++facts.boundary_edges;
    if (edge.size() > 2) ++facts.non_manifold_edges;
    if (edge.size() == 2 && edge[0].forward == edge[1].forward) ++facts.flipped_neighbours;
  });
  if (facts.boundary_edges > 0) facts.holes = count_holes(sides, welded.size());
  return facts;
}

std::vector<std::string> describe(const MeshFacts& facts) {
  const Vec3 size = facts.bounds.empty() ? Vec3::Zero() : facts.bounds.size();
  std::vector<std::string> lines{
      fmt::format("{}, {}, {}, {}, {:.6g} x {:.6g} x {:.6g}", how_many(facts.distinct_vertices, "vertex", "vertices"),
                  how_many(facts.triangles, "triangle", "triangles"), how_many(facts.pieces, "piece", "pieces"),
                  facts.closed() ? "closed" : "not closed", size.x(), size.y(), size.z())};
  const auto say = [&](std::int64_t count, const char* one, const char* many, const char* rest) {
    if (count > 0) lines.push_back(how_many(count, one, many) + rest);
  };
  say(facts.holes, "hole", "holes", fmt::format(" ({} boundary edges)", facts.boundary_edges).c_str());
  say(facts.non_manifold_edges, "edge", "edges", " of more than two faces");
  say(facts.flipped_neighbours, "edge", "edges", " whose two faces point to opposite sides");
  say(facts.duplicate_triangles, "duplicate face", "duplicate faces", "");
  say(facts.collapsed_triangles, "face", "faces", " with two corners in one place");
  say(facts.flat_triangles, "face", "faces", " without area");
  say(facts.vertices - facts.used_vertices, "vertex", "vertices", " used by no face");
  say(facts.not_finite, "vertex", "vertices", " with coordinates that are not finite");
  if (facts.closed() && facts.flipped_neighbours == 0 && facts.signed_volume < 0)
    lines.emplace_back("all faces point inward (the signed volume is negative)");
  return lines;
}

}  // namespace softreel
