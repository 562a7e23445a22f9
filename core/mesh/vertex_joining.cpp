#include "core/mesh/vertex_joining.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "core/mesh/mesh_topology.h"

namespace softreel {
namespace {

/// Of the box's diagonal; above the rounding of floats in a file, below what is modelled.
constexpr double kReach = 1e-5;

/// Of the shortest edge at a vertex, so that no triangle collapses.
constexpr double kShareOfEdge = 0.25;

/// How far each welded vertex on a rim may be moved, m; 0 for all others.
std::vector<double> rim_reaches(const SurfaceMesh& mesh, const std::vector<Index>& weld) {
  std::vector<double> reaches(mesh.positions.size(), 0.0);
  const double most = kReach * used_bounds(mesh).diagonal();
  const std::vector<HalfEdge> sides = sorted_half_edges(welded_triangles(mesh.triangles, weld));
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    if (edge.size() == 1)
      for (const Index v : {edge[0].low, edge[0].high}) reaches[static_cast<std::size_t>(v)] = most;
  });
  for (const HalfEdge& side : sides) {
    const auto low = static_cast<std::size_t>(side.low), high = static_cast<std::size_t>(side.high);
    const double length = kShareOfEdge * (mesh.positions[low] - mesh.positions[high]).norm();
    reaches[low] = std::min(reaches[low], length);
    reaches[high] = std::min(reaches[high], length);
  }
  return reaches;
}

/// Vertices by cubic cells: the cell's place as a number, x before y before z.
struct CellEntry {
  std::uint64_t key;
  Index vertex;
};

/// Steps of the key along x and y; each place has a margin of 1 on either side.
constexpr std::uint64_t kStepY = std::uint64_t{1} << 21, kStepX = kStepY << 21;

std::vector<CellEntry> sort_into_cells(const SurfaceMesh& mesh, const std::vector<Index>& vertices, double size) {
  Bounds box;
  for (const Index v : vertices) box.add(mesh.positions[static_cast<std::size_t>(v)]);
  std::vector<CellEntry> cells;
  for (const Index v : vertices) {
    const Vec3 place = (mesh.positions[static_cast<std::size_t>(v)] - box.min) / size;
    const auto number = [&](int axis) { return static_cast<std::uint64_t>(place[axis]) + 1; };
    cells.push_back({number(0) * kStepX + number(1) * kStepY + number(2), v});
  }
  std::sort(cells.begin(), cells.end(), [](const CellEntry& a, const CellEntry& b) {
    return a.key < b.key || (a.key == b.key && a.vertex < b.vertex);
  });
  return cells;
}

/// Calls visit(a, b) once for each pair of vertices in one cell or in neighbouring ones. Linear in their number.
template <typename Visit>
void visit_neighbours(const std::vector<CellEntry>& cells, const Visit& visit) {
  // Forward neighbours: the rest of the own column of cells, and the four columns beside it, three cells of each.
  for (const std::uint64_t column : {std::uint64_t{0}, kStepY, kStepX - kStepY, kStepX, kStepX + kStepY}) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (column == 0) {
        begin = i + 1;
      } else {
        while (begin < cells.size() && cells[begin].key + 1 < cells[i].key + column) ++begin;
      }
      for (std::size_t j = begin; j < cells.size() && cells[j].key <= cells[i].key + column + 1; ++j)
        visit(cells[i].vertex, cells[j].vertex);
    }
  }
}

}  // namespace

std::vector<Index> join_vertices(const SurfaceMesh& mesh, std::int64_t& joined) {
  joined = 0;
  std::vector<Index> weld = weld_positions(mesh.positions);
  const std::vector<double> reaches = rim_reaches(mesh, weld);
  std::vector<Index> rim;
  for (std::size_t v = 0; v < reaches.size(); ++v)
    if (reaches[v] > 0 && std::isfinite(reaches[v])) rim.push_back(static_cast<Index>(v));
  if (rim.empty()) return weld;
  const auto reach = [&](Index v) { return reaches[static_cast<std::size_t>(v)]; };
  const auto position = [&](Index v) -> const Vec3& { return mesh.positions[static_cast<std::size_t>(v)]; };
  DisjointSets sets(mesh.positions.size());
  visit_neighbours(sort_into_cells(mesh, rim, kReach * used_bounds(mesh).diagonal()), [&](Index a, Index b) {
    const double both = std::min(reach(a), reach(b));
    if ((position(a) - position(b)).squaredNorm() <= both * both) sets.join(a, b);
  });
  for (const Index v : rim) joined += sets.root(v) != v ? 1 : 0;
  for (Index& v : weld) v = sets.root(v);
  return weld;
}

}  // namespace softreel
