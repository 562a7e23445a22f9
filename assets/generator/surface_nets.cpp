#include "assets/generator/surface_nets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "assets/generator/lattice.h"
#include "core/base/error.h"
#include "core/base/srgb.h"

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

/// The edge from corner `low` of a cell along an axis, where low's bit of that axis is 0: one of twelve.
std::size_t edge_slot(int low, int axis) {
  return static_cast<std::size_t>(axis * 8 + low);
}

/// The sheets of surface in a cell, as labels of the lattice edges that they cut.
struct Sheets {
  std::array<int, 24> of_edge;  ///< by edge_slot; -1: not cut
  int count = 0;
};

/// Joins the cut edges of the cell's face on the given side of an axis, as the cell beyond it does too: the only two
/// with one another; of four, those round each inside corner. So sheets fit together and meet each edge once.
void join_across_face(const std::array<bool, 8>& inside, int axis, int side, Sheets& sheets) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3, base = side << axis;
  const auto corner = [&](int i, int j) { return base | i << u | j << v; };
  const std::array<std::size_t, 4> edges{edge_slot(corner(0, 0), u), edge_slot(corner(0, 1), u),
                                         edge_slot(corner(0, 0), v), edge_slot(corner(1, 0), v)};
  const auto join = [&](std::size_t a, std::size_t b) {
    const int from = sheets.of_edge[b], to = sheets.of_edge[a];
    for (int& label : sheets.of_edge)
      if (label == from) label = to;
  };
  std::vector<std::size_t> cut;
  for (const std::size_t edge : edges)
    if (sheets.of_edge[edge] >= 0) cut.push_back(edge);
  if (cut.size() == 2) join(cut[0], cut[1]);
  if (cut.size() < 4) return;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      if (inside[static_cast<std::size_t>(corner(i, j))]) join(edge_slot(corner(0, j), u), edge_slot(corner(i, 0), v));
}

Sheets find_sheets(const Lattice& lattice, const Cell& cell) {
  Sheets sheets;
  sheets.of_edge.fill(-1);
  std::array<bool, 8> inside{};
  for (int k = 0; k < 8; ++k) inside[static_cast<std::size_t>(k)] = lattice.value(corner_node(cell, k)) < 0;
  if (std::equal(inside.begin() + 1, inside.end(), inside.begin())) return sheets;
  for (int axis = 0; axis < 3; ++axis)
    for (int low = 0; low < 8; ++low) {
      if (low >> axis & 1) continue;
      const std::size_t slot = edge_slot(low, axis);
      if (inside[static_cast<std::size_t>(low)] != inside[static_cast<std::size_t>(low | 1 << axis)])
        sheets.of_edge[slot] = static_cast<int>(slot);
    }
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) join_across_face(inside, axis, side, sheets);
  std::array<int, 24> number{};
  number.fill(-1);
  for (int& label : sheets.of_edge) {
    if (label < 0) continue;
    int& n = number[static_cast<std::size_t>(label)];
    if (n < 0) n = sheets.count++;
    label = n;
  }
  return sheets;
}

/// Mean of the points where one sheet cuts the edges of a cell.
Vec3 sheet_point(const Lattice& lattice, const Cell& cell, const Sheets& sheets, int sheet) {
  Vec3 sum = Vec3::Zero();
  int cuts = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int low = 0; low < 8; ++low) {
      if (sheets.of_edge[edge_slot(low, axis)] != sheet) continue;
      const Cell from = corner_node(cell, low), to = corner_node(cell, low | 1 << axis);
      const double a = lattice.value(from), b = lattice.value(to);
      sum += lattice.point(from) + a / (a - b) * (lattice.point(to) - lattice.point(from));
      ++cuts;
    }
  return sum / cuts;
}

/// The quadrilateral round each cut lattice edge, counter-clockwise seen from outside.
void add_quads(const Lattice& lattice, const std::vector<Index>& first_vertex, std::vector<Quad>& quads) {
  lattice.for_each_cell([&](const Cell& node) {
    for (int axis = 0; axis < 3; ++axis) {
      Cell next = node;
      next[static_cast<std::size_t>(axis)] += 1;
      const bool inside = lattice.value(node) < 0;
      if (inside == (lattice.value(next) < 0)) continue;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      Quad quad{};
      constexpr std::array<std::array<int, 2>, 4> kRound{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
      for (std::size_t k = 0; k < 4; ++k) {
        Cell cell = node;
        cell[static_cast<std::size_t>(u)] -= kRound[k][0];
        cell[static_cast<std::size_t>(v)] -= kRound[k][1];
        const std::size_t slot = edge_slot(kRound[k][0] << u | kRound[k][1] << v, axis);
        quad[k] = first_vertex[lattice.index(cell)] + find_sheets(lattice, cell).of_edge[slot];
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
    const Sheets sheets = find_sheets(lattice, cell);
    first_vertex[lattice.index(cell)] = static_cast<Index>(mesh.positions.size());
    for (int sheet = 0; sheet < sheets.count; ++sheet)
      mesh.positions.push_back(sheet_point(lattice, cell, sheets, sheet));
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

/// Calls visit(v, position of v) for each vertex.
template <typename Visit>
void for_each_point(QuadMesh& mesh, const Threads& threads, const Visit& visit) {
  threads.for_chunks(static_cast<std::int64_t>(mesh.positions.size()), 1024, [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) visit(v, mesh.positions[v]);
  });
}

/// Moves each vertex to the mean of its edge neighbours, along the surface only.
void relax(const Sculpture& sculpture, QuadMesh& mesh, const Threads& threads) {
  std::vector<Vec3> sum(mesh.positions.size(), Vec3::Zero());
  std::vector<int> count(mesh.positions.size(), 0);
  for (const Quad& quad : mesh.quads)
    for (std::size_t k = 0; k < 4; ++k) {
      sum[at(quad[k])] += mesh.positions[at(quad[(k + 1) % 4])] + mesh.positions[at(quad[(k + 3) % 4])];
      count[at(quad[k])] += 2;
    }
  for_each_point(mesh, threads, [&](std::size_t v, Vec3& p) {
    const Vec3 normal = gradient(sculpture, p).normalized(), move = sum[v] / count[v] - p;
    p = projected(sculpture, p + move - move.dot(normal) * normal, 1);
  });
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

/// A coordinate of its own for each corner, so that every triangle lies in one chart.
void add_texture_coordinates(const Sculpture& sculpture, SurfaceMesh& mesh) {
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[at(t[0])], &b = mesh.positions[at(t[1])], &c = mesh.positions[at(t[2])];
    const Vec3 normal = (b - a).cross(c - a).normalized();
    Triangle& corners = mesh.triangle_textures.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = static_cast<Index>(mesh.texture_coordinates.size());
      mesh.texture_coordinates.push_back(sculpture.texture_coordinate(mesh.positions[at(t[k])], normal));
    }
  }
}

void add_colors(const Sculpture& sculpture, SurfaceMesh& mesh) {
  for (const Vec3& p : mesh.positions) {
    const Vec3 code = sculpture.color(p);
    Vec3f& linear = mesh.colors.emplace_back();
    for (int k = 0; k < 3; ++k) linear[k] = srgb_decode(static_cast<float>(std::clamp(code[k], 0.0, 1.0)));
  }
}

}  // namespace

SurfaceMesh mesh_surface(const Sculpture& sculpture, int relaxations, const Threads& threads) {
  const auto project_all = [&](QuadMesh& mesh) {
    for_each_point(mesh, threads, [&](std::size_t, Vec3& p) { p = projected(sculpture, p, 2); });
  };
  QuadMesh quads = extract(Lattice(sculpture, threads));
  project_all(quads);
  for (int round = 0; round < relaxations; ++round) relax(sculpture, quads, threads);
  project_all(quads);
  SurfaceMesh mesh;
  mesh.positions = quads.positions;
  mesh.triangles = cut_quads(quads);
  check_closed(sculpture.name, mesh.positions, mesh.triangles);
  if (sculpture.color) add_colors(sculpture, mesh);
  if (sculpture.texture_coordinate) add_texture_coordinates(sculpture, mesh);
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
