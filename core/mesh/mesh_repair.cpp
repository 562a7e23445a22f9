#include "core/mesh/mesh_repair.h"

#include <algorithm>
#include <array>
#include <tuple>

#include <fmt/format.h>

#include "core/mesh/mesh_topology.h"
#include "core/mesh/shell_nesting.h"
#include "core/mesh/vertex_joining.h"

namespace softreel {
namespace {

/// Keeps the triangles marked 1; returns how many were removed.
std::int64_t keep_triangles(SurfaceMesh& mesh, const std::vector<char>& kept) {
  std::size_t end = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (kept[t] == 0) continue;
    mesh.triangles[end] = mesh.triangles[t];
    if (!mesh.triangle_polygon.empty()) mesh.triangle_polygon[end] = mesh.triangle_polygon[t];
    if (!mesh.triangle_textures.empty()) mesh.triangle_textures[end] = mesh.triangle_textures[t];
    ++end;
  }
  const auto removed = static_cast<std::int64_t>(mesh.triangles.size() - end);
  mesh.triangles.resize(end);
  if (!mesh.triangle_polygon.empty()) mesh.triangle_polygon.resize(end);
  if (!mesh.triangle_textures.empty()) mesh.triangle_textures.resize(end);
  return removed;
}

/// Per triangle: 1 if it was turned an odd number of times.
using Turned = std::vector<char>;

void flip_triangle(SurfaceMesh& mesh, std::size_t t, Turned& turned) {
  std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  if (!mesh.triangle_textures.empty()) std::swap(mesh.triangle_textures[t][1], mesh.triangle_textures[t][2]);
  turned[t] = turned[t] == 0 ? 1 : 0;
}

/// Polygons go as their triangles do (any of them: a polygon's are turned together), as they are what exports write.
/// Their first corners stay; those that lost all triangles are left as they are.
void turn_polygons(SurfaceMesh& mesh, const Turned& turned) {
  PolygonList& polygons = mesh.polygons;
  if (polygons.size() == 0) return;  // a surface that was made of triangles
  std::vector<char> done(polygons.size(), 0);
  for (std::size_t t = 0; t < mesh.triangle_polygon.size(); ++t) {
    const auto p = static_cast<std::size_t>(mesh.triangle_polygon[t]);
    if (turned[t] == 0 || done[p] != 0) continue;
    done[p] = 1;
    for (std::vector<Index>* corners : {&polygons.corner_vertices, &polygons.corner_textures})
      if (!corners->empty())
        std::reverse(corners->begin() + polygons.offsets[p] + 1, corners->begin() + polygons.offsets[p + 1]);
  }
}

void remove_not_finite(SurfaceMesh& mesh, std::vector<std::string>& lines) {
  std::vector<char> kept(mesh.triangles.size(), 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index v : mesh.triangles[t])
      if (!mesh.positions[static_cast<std::size_t>(v)].allFinite()) kept[t] = 0;
  if (const std::int64_t removed = keep_triangles(mesh, kept); removed > 0)
    lines.push_back(fmt::format("{} triangle(s) with coordinates that are not finite removed", removed));
}

void remove_collapsed(SurfaceMesh& mesh, const std::vector<Index>& weld, std::vector<std::string>& lines) {
  const std::vector<Triangle> welded = welded_triangles(mesh.triangles, weld);
  std::vector<char> kept(welded.size());
  for (std::size_t t = 0; t < welded.size(); ++t) kept[t] = is_collapsed(welded[t]) ? 0 : 1;
  if (const std::int64_t removed = keep_triangles(mesh, kept); removed > 0)
    lines.push_back(fmt::format("{} triangle(s) with two corners in one place removed", removed));
}

/// Corners rotated so that the smallest comes first: equal for equal triangles of one orientation.
Triangle rotated_to_smallest(const Triangle& t) {
  const auto k = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  return {t[k], t[(k + 1) % 3], t[(k + 2) % 3]};
}

/// Triangles on the same three places: the first of them, and the first of the other orientation (-1 if there is none).
struct Twins {
  Index first, opposite = -1;
};

/// Groups of triangles with equal corners, by their first triangle.
std::vector<Twins> find_twins(const std::vector<Triangle>& welded) {
  struct Entry {
    Triangle sorted;
    Index triangle;
  };
  std::vector<Entry> entries;
  for (std::size_t t = 0; t < welded.size(); ++t) {
    entries.push_back({welded[t], static_cast<Index>(t)});
    std::sort(entries.back().sorted.begin(), entries.back().sorted.end());
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.sorted, a.triangle) < std::tie(b.sorted, b.triangle);
  });
  std::vector<Twins> twins;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || entries[i].sorted != entries[i - 1].sorted) {
      twins.push_back({entries[i].triangle});
      continue;
    }
    const auto rotated = [&](Index t) { return rotated_to_smallest(welded[static_cast<std::size_t>(t)]); };
    Twins& last = twins.back();
    if (last.opposite < 0 && rotated(entries[i].triangle) != rotated(last.first)) last.opposite = entries[i].triangle;
  }
  return twins;
}

/// Marks the distinct faces (by index into twins) that are walls: patches of opposite twins that end at an edge of
/// three or more distinct faces.
std::vector<char> find_walls(const std::vector<Twins>& twins, const std::vector<Triangle>& welded) {
  std::vector<Triangle> distinct;
  for (const Twins& face : twins) distinct.push_back(welded[static_cast<std::size_t>(face.first)]);
  const std::vector<HalfEdge> sides = sorted_half_edges(distinct);
  const auto has_opposite = [&](const HalfEdge& side) {
    return twins[static_cast<std::size_t>(side.triangle)].opposite >= 0;
  };
  DisjointSets patches(twins.size());
  for_each_edge(sides, [&](std::span<const HalfEdge> edge) {
    if (edge.size() == 2 && has_opposite(edge[0]) && has_opposite(edge[1]))
      patches.join(edge[0].triangle, edge[1].triangle);
  });
  std::vector<char> patch_is_wall(twins.size(), 0), is_wall(twins.size(), 0);
  for_each_edge(sides, [&](std::span<const HalfEdge> edge) {
    if (edge.size() < 3 || edge.size() % 2 == 0) return;
    for (const HalfEdge& side : edge)
      if (has_opposite(side)) patch_is_wall[static_cast<std::size_t>(patches.root(side.triangle))] = 1;
  });
  for (std::size_t f = 0; f < twins.size(); ++f)
    is_wall[f] =
        twins[f].opposite >= 0 ? patch_is_wall[static_cast<std::size_t>(patches.root(static_cast<Index>(f)))] : 0;
  return is_wall;
}

void remove_duplicates(SurfaceMesh& mesh, const std::vector<Index>& weld, std::vector<std::string>& lines) {
  const std::vector<Triangle> welded = welded_triangles(mesh.triangles, weld);
  const std::vector<Twins> twins = find_twins(welded);
  if (twins.size() == welded.size()) return;
  const std::vector<char> is_wall = find_walls(twins, welded);
  const auto walls = std::count(is_wall.begin(), is_wall.end(), 1);
  std::vector<char> kept(welded.size(), 0);
  for (std::size_t f = 0; f < twins.size(); ++f)
    if (is_wall[f] == 0) kept[static_cast<std::size_t>(twins[f].first)] = 1;
  const std::int64_t removed = keep_triangles(mesh, kept) - 2 * walls;
  if (walls > 0) lines.push_back(fmt::format("{} triangle(s) of two-sided inner walls removed", 2 * walls));
  if (removed > 0) lines.push_back(fmt::format("{} duplicate triangle(s) removed", removed));
}

/// Triangles connected across edges of exactly two triangles, and which of them to flip so that they agree.
struct Orientation {
  std::vector<Index> piece;     ///< of each triangle, numbered from 0 in the order of their first triangles
  std::vector<char> flip;       ///< of each triangle, relative to the first one of its piece
  std::vector<char> one_sided;  ///< of each piece
};

Orientation orient(const std::vector<HalfEdge>& sides, std::size_t triangles) {
  struct Link {
    Index to = -1;
    bool disagrees = false;
  };
  std::vector<std::array<Link, 3>> links(triangles);  // at most one a side
  const auto add_link = [&](Index from, Index to, bool disagrees) {
    auto& own = links[static_cast<std::size_t>(from)];
    *std::find_if(own.begin(), own.end(), [](const Link& link) { return link.to < 0; }) = {to, disagrees};
  };
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    if (edge.size() != 2) return;
    const bool disagrees = edge[0].forward == edge[1].forward;
    add_link(edge[0].triangle, edge[1].triangle, disagrees);
    add_link(edge[1].triangle, edge[0].triangle, disagrees);
  });
  Orientation result{std::vector<Index>(triangles, -1), std::vector<char>(triangles, 0), {}};
  std::vector<std::size_t> front;
  for (std::size_t seed = 0; seed < triangles; ++seed) {
    if (result.piece[seed] >= 0) continue;
    const auto piece = static_cast<Index>(result.one_sided.size());
    result.one_sided.push_back(0);
    result.piece[seed] = piece;
    front.assign(1, seed);
    while (!front.empty()) {
      const std::size_t t = front.back();
      front.pop_back();
      for (const Link& link : links[t]) {
        if (link.to < 0) break;
        const auto to = static_cast<std::size_t>(link.to);
        const char flip = static_cast<char>((result.flip[t] != 0) != link.disagrees);
        if (result.piece[to] < 0) {
          result.piece[to] = piece;
          result.flip[to] = flip;
          front.push_back(to);
        } else if (result.flip[to] != flip) {
          result.one_sided.back() = 1;
        }
      }
    }
  }
  return result;
}

double triangle_area(const SurfaceMesh& mesh, std::size_t t) {
  const auto at = [&](std::size_t k) -> const Vec3& {
    return mesh.positions[static_cast<std::size_t>(mesh.triangles[t][k])];
  };
  return 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
}

/// Makes neighbours agree: within each piece the smaller area gives way. Returns the piece of each triangle.
std::vector<Index> make_consistent(SurfaceMesh& mesh, const std::vector<HalfEdge>& sides, Turned& turned,
                                   std::vector<std::string>& lines) {
  const Orientation orientation = orient(sides, mesh.triangles.size());
  std::vector<double> balance(orientation.one_sided.size(), 0);  // area to keep minus area to flip
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    balance[static_cast<std::size_t>(orientation.piece[t])] +=
        orientation.flip[t] != 0 ? -triangle_area(mesh, t) : triangle_area(mesh, t);
  std::int64_t flipped = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto piece = static_cast<std::size_t>(orientation.piece[t]);
    if (orientation.one_sided[piece] != 0 || (orientation.flip[t] != 0) != (balance[piece] >= 0)) continue;
    flip_triangle(mesh, t, turned);
    ++flipped;
  }
  if (flipped > 0) lines.push_back(fmt::format("{} triangle(s) turned to agree with their neighbours", flipped));
  const auto one_sided = std::count(orientation.one_sided.begin(), orientation.one_sided.end(), 1);
  if (one_sided > 0)
    lines.push_back(fmt::format("{} one-sided piece(s) cannot be oriented and stay as they are", one_sided));
  return orientation.piece;
}

/// Marks the pieces whose own half edges cancel along every edge.
std::vector<char> find_closed(const std::vector<HalfEdge>& sides, const std::vector<Index>& piece, std::size_t pieces) {
  std::vector<char> closed(pieces, 1);
  std::vector<std::pair<Index, int>> balance;  // piece, 1 for a half edge forward, -1 for one backward
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    balance.clear();
    for (const HalfEdge& side : edge)
      balance.emplace_back(piece[static_cast<std::size_t>(side.triangle)], side.forward ? 1 : -1);
    std::sort(balance.begin(), balance.end());
    for (std::size_t begin = 0, end = 0; begin < balance.size(); begin = end) {
      int sum = 0;
      for (end = begin; end < balance.size() && balance[end].first == balance[begin].first; ++end)
        sum += balance[end].second;
      if (sum != 0) closed[static_cast<std::size_t>(balance[begin].first)] = 0;
    }
  });
  return closed;
}

void turn_outward(SurfaceMesh& mesh, const std::vector<HalfEdge>& sides, const std::vector<Index>& piece,
                  Turned& turned, std::vector<std::string>& lines) {
  const std::size_t pieces =
      piece.empty() ? 0 : static_cast<std::size_t>(*std::max_element(piece.begin(), piece.end())) + 1;
  const std::vector<char> closed = find_closed(sides, piece, pieces);
  const std::vector<char> flip = find_inverted_shells(mesh, piece, closed);
  const auto inverted = std::count(flip.begin(), flip.end(), 1);
  if (inverted == 0) return;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (flip[static_cast<std::size_t>(piece[t])] != 0) flip_triangle(mesh, t, turned);
  lines.push_back(pieces == 1 ? "all faces pointed inward: turned outward"
                              : fmt::format("{} of {} pieces turned outward", inverted, pieces));
}

}  // namespace

std::vector<std::string> repair_mesh(SurfaceMesh& mesh) {
  std::vector<std::string> lines;
  remove_not_finite(mesh, lines);
  std::int64_t joined = 0;
  const std::vector<Index> weld = join_vertices(mesh, joined);
  if (joined > 0) {
    mesh.joined = weld;
    lines.push_back(
        fmt::format("{} vertex place(s) on open edges joined with others less than 1e-5 of the size away", joined));
  }
  remove_collapsed(mesh, weld, lines);
  remove_duplicates(mesh, weld, lines);
  const std::vector<HalfEdge> given = sorted_half_edges(welded_triangles(mesh.triangles, weld));
  Turned turned(mesh.triangles.size(), 0);
  const std::vector<Index> piece = make_consistent(mesh, given, turned, lines);
  turn_outward(mesh, sorted_half_edges(welded_triangles(mesh.triangles, weld)), piece, turned, lines);
  turn_polygons(mesh, turned);
  return lines;
}

}  // namespace softreel
