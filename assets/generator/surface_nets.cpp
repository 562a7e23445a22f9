#include "assets/generator/surface_nets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "assets/generator/lattice.h"
#include "core/base/error.h"

namespace softreel::sculpt {

namespace {

using Quad = std::array<Index, 4>;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

struct QuadMesh {
  std::vector<Vec3> positions;
  std::vector<Quad> quads;
};

using Cell = std::array<int, 3>;

/// Corner k of a cell: bit 0 counts along x, 1 along y, 2 along z.
Cell corner_node(const Cell& cell, int k) {
  return {cell[0] + (k & 1), cell[1] + (k >> 1 & 1), cell[2] + (k >> 2)};
}

/// Which piece of the solid each corner of a cell belongs to: corners inside that the cell's edges join are one piece.
struct Pieces {
  std::array<int, 8> of_corner;  ///< -1: outside
  int count = 0;                 ///< 0 too where all corners are inside: no surface
};

Pieces find_pieces(const Lattice& lattice, const Cell& cell) {
  Pieces pieces;
  pieces.of_corner.fill(-1);
  std::array<bool, 8> inside{};
  for (int k = 0; k < 8; ++k) inside[static_cast<std::size_t>(k)] = lattice.value(corner_node(cell, k)) < 0;
  if (std::all_of(inside.begin(), inside.end(), [](bool b) { return b; })) return pieces;
  for (int seed = 0; seed < 8; ++seed) {
    if (!inside[static_cast<std::size_t>(seed)] || pieces.of_corner[static_cast<std::size_t>(seed)] >= 0) continue;
    std::vector<int> open{seed};
    pieces.of_corner[static_cast<std::size_t>(seed)] = pieces.count;
    while (!open.empty()) {
      const int k = open.back();
      open.pop_back();
      for (const int bit : {1, 2, 4}) {
        const auto next = static_cast<std::size_t>(k ^ bit);
        if (!inside[next] || pieces.of_corner[next] >= 0) continue;
        pieces.of_corner[next] = pieces.count;
        open.push_back(k ^ bit);
      }
    }
    ++pieces.count;
  }
  return pieces;
}

/// Mean of the points where the surface of one piece cuts the twelve edges of a cell.
Vec3 piece_point(const Lattice& lattice, const Cell& cell, const Pieces& pieces, int piece) {
  Vec3 sum = Vec3::Zero();
  int cuts = 0;
  for (int k = 0; k < 8; ++k) {
    if (pieces.of_corner[static_cast<std::size_t>(k)] != piece) continue;
    for (const int bit : {1, 2, 4}) {
      const Cell from = corner_node(cell, k), to = corner_node(cell, k ^ bit);
      const double a = lattice.value(from), b = lattice.value(to);
      if (b < 0) continue;
      sum += lattice.point(from) + a / (a - b) * (lattice.point(to) - lattice.point(from));
      ++cuts;
    }
  }
  return sum / cuts;
}

/// The quadrilateral round each cut lattice edge, counter-clockwise seen from outside.
void add_quads(const Lattice& lattice, const std::vector<Index>& first_vertex, std::vector<Quad>& quads) {
  lattice.for_each_cell([&](const Cell& node) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Cell next = node;
      next[axis] += 1;
      const bool inside = lattice.value(node) < 0;
      if (inside == (lattice.value(next) < 0)) continue;
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      Quad quad{};
      constexpr std::array<std::array<int, 2>, 4> kRound{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
      for (std::size_t k = 0; k < 4; ++k) {
        Cell cell = node;
        cell[u] -= kRound[k][0];
        cell[v] -= kRound[k][1];
        const int corner = (kRound[k][0] << u) | (kRound[k][1] << v) | ((inside ? 0 : 1) << axis);
        const int piece = find_pieces(lattice, cell).of_corner[static_cast<std::size_t>(corner)];
        quad[k] = first_vertex[lattice.index(cell)] + piece;
      }
      if (!inside) std::reverse(quad.begin(), quad.end());
      quads.push_back(quad);
    }
  });
}

QuadMesh extract(const Lattice& lattice) {
  QuadMesh mesh;
  std::vector<Index> first_vertex(lattice.size(), -1);
  lattice.for_each_cell([&](const Cell& cell) {
    const Pieces pieces = find_pieces(lattice, cell);
    first_vertex[lattice.index(cell)] = static_cast<Index>(mesh.positions.size());
    for (int piece = 0; piece < pieces.count; ++piece)
      mesh.positions.push_back(piece_point(lattice, cell, pieces, piece));
  });
  add_quads(lattice, first_vertex, mesh.quads);
  return mesh;
}

/// Gradient of the distance by central differences.
Vec3 gradient(const Sculpture& sculpture, const Vec3& p) {
  const double step = 0.05 * sculpture.cell;
  Vec3 g;
  for (int k = 0; k < 3; ++k) {
    const Vec3 offset = step * Vec3::Unit(k);
    g[k] = (sculpture.distance(p + offset) - sculpture.distance(p - offset)) / (2 * step);
  }
  return g;
}

/// Newton steps onto the isosurface; none is longer than a cell, so that a point stays with its own sheet.
Vec3 projected(const Sculpture& sculpture, Vec3 p, int steps) {
  for (int step = 0; step < steps; ++step) {
    const Vec3 g = gradient(sculpture, p);
    Vec3 move = -sculpture.distance(p) / std::max(g.squaredNorm(), 1e-6) * g;
    if (move.norm() > sculpture.cell) move *= sculpture.cell / move.norm();
    p += move;
  }
  return p;
}

/// Moves each vertex to the mean of its edge neighbours, along the surface only.
void relax(const Sculpture& sculpture, QuadMesh& mesh) {
  std::vector<Vec3> sum(mesh.positions.size(), Vec3::Zero());
  std::vector<int> count(mesh.positions.size(), 0);
  for (const Quad& quad : mesh.quads)
    for (std::size_t k = 0; k < 4; ++k) {
      sum[at(quad[k])] += mesh.positions[at(quad[(k + 1) % 4])] + mesh.positions[at(quad[(k + 3) % 4])];
      count[at(quad[k])] += 2;
    }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    Vec3& p = mesh.positions[v];
    const Vec3 normal = gradient(sculpture, p).normalized(), move = sum[v] / count[v] - p;
    p = projected(sculpture, p + move - move.dot(normal) * normal, 1);
  }
}

std::vector<Triangle> cut_quads(const QuadMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(2 * mesh.quads.size());
  for (const Quad& q : mesh.quads) {
    const auto length = [&](std::size_t a, std::size_t b) {
      return (mesh.positions[at(q[a])] - mesh.positions[at(q[b])]).squaredNorm();
    };
    const std::size_t s = length(0, 2) <= length(1, 3) ? 0 : 1;
    triangles.push_back({q[s], q[s + 1], q[s + 2]});
    triangles.push_back({q[s], q[s + 2], q[(s + 3) % 4]});
  }
  return triangles;
}

/// Number of pieces that triangles join.
int count_pieces(std::size_t vertices, const std::vector<Triangle>& triangles) {
  std::vector<Index> parent(vertices);
  for (std::size_t v = 0; v < vertices; ++v) parent[v] = static_cast<Index>(v);
  const auto root = [&](Index v) {
    while (parent[at(v)] != v) v = parent[at(v)] = parent[at(parent[at(v)])];
    return v;
  };
  int pieces = static_cast<int>(vertices);
  for (const Triangle& t : triangles)
    for (std::size_t k = 1; k < 3; ++k) {
      const Index a = root(t[0]), b = root(t[k]);
      if (a == b) continue;
      parent[at(b)] = a;
      --pieces;
    }
  return pieces;
}

std::string place(const Vec3& p) {
  return fmt::format("({:.4f}, {:.4f}, {:.4f})", p.x(), p.y(), p.z());
}

/// One closed manifold without handles: each directed edge once, its reverse once, Euler characteristic 2, one piece.
void check_closed(const std::string& name, const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  std::map<std::pair<Index, Index>, int> edges;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    const auto reverse = edges.find({edge.second, edge.first});
    if (count != 1 || reverse == edges.end())
      throw work_error(name + ": the surface is not a closed manifold at " + place(positions[at(edge.first)]) +
                       ". Make the sculpture's cell smaller or its details larger.");
  }
  const auto euler = static_cast<std::int64_t>(positions.size()) - static_cast<std::int64_t>(edges.size() / 2) +
                     static_cast<std::int64_t>(triangles.size());
  const int pieces = count_pieces(positions.size(), triangles);
  if (pieces != 1 || euler != 2)
    throw work_error(name + ": the surface has " + std::to_string(pieces) + " pieces and Euler characteristic " +
                     std::to_string(euler) +
                     "; accepted is one piece with 2 (no handles). Look for parts that touch or float.");
}

}  // namespace

SurfaceMesh mesh_surface(const Sculpture& sculpture, int relaxations) {
  QuadMesh quads = extract(Lattice(sculpture));
  for (Vec3& p : quads.positions) p = projected(sculpture, p, 2);
  for (int round = 0; round < relaxations; ++round) relax(sculpture, quads);
  for (Vec3& p : quads.positions) p = projected(sculpture, p, 2);
  SurfaceMesh mesh;
  mesh.positions = quads.positions;
  mesh.triangles = cut_quads(quads);
  check_closed(sculpture.name, mesh.positions, mesh.triangles);
  for (const Part& part : sculpture.parts) {
    VertexGroup group{part.name, {}};
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      if (part.contains(mesh.positions[v])) group.vertices.push_back(static_cast<Index>(v));
    if (group.vertices.empty()) throw work_error(sculpture.name + ": the part " + part.name + " has no vertices.");
    mesh.groups.push_back(std::move(group));
  }
  return mesh;
}

}  // namespace softreel::sculpt
