#include "core/tetmesh/surface/surface_parts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/mesh/mesh_topology.h"
#include "core/mesh/winding_number.h"
#include "core/tetmesh/key_index.h"

namespace softreel {
namespace {

/// Per vertex the first group that holds it, -1 if none does; empty without groups.
std::vector<Index> first_groups(const SurfaceMesh& surface) {
  std::vector<Index> first(surface.groups.empty() ? 0 : surface.positions.size(), -1);
  for (std::size_t g = surface.groups.size(); g-- > 0;)
    for (const Index vertex : surface.groups[g].vertices) first[at(vertex)] = static_cast<Index>(g);
  return first;
}

/// Volumes of closed parts about their own middle: far from it that of a small one is round-off. That of an open part
/// is another about another point, and panels that make up a body only do so together: about the middle of all of them.
void measure_parts(const SurfaceMesh& surface, SurfaceParts& found) {
  Bounds open;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (found.triangle_parts[t] < 0) continue;
    SurfacePart& part = found.parts[at(found.triangle_parts[t])];
    for (const Index v : surface.triangles[t]) {
      part.box.add(surface.positions[at(v)]);
      if (part.open) open.add(surface.positions[at(v)]);
    }
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (found.triangle_parts[t] < 0) continue;
    SurfacePart& part = found.parts[at(found.triangle_parts[t])];
    const Vec3 center = part.open ? open.center() : part.box.center();
    std::array<Vec3, 3> x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = surface.positions[at(surface.triangles[t][k])] - center;
    ++part.triangles;
    part.volume += x[0].cross(x[1]).dot(x[2]) / 6.0;
    part.area += 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
  }
}

/// Welded vertices of edges whose triangles do not run along them as often in one direction as in the other.
std::vector<Index> find_rims(const std::vector<Triangle>& welded) {
  std::vector<Index> rims;
  const std::vector<HalfEdge> sides = sorted_half_edges(welded);
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    if (!is_balanced(edge)) rims.insert(rims.end(), {edge[0].low, edge[0].high});
  });
  std::sort(rims.begin(), rims.end());
  rims.erase(std::unique(rims.begin(), rims.end()), rims.end());
  return rims;
}

/// Joins sets with vertices in one cell of either of two grids that are half a cell apart: about a hundredth of the
/// box.
void join_near_rims(const SurfaceMesh& surface, const std::vector<Index>& rims, DisjointSets& sets) {
  const Bounds box = used_bounds(surface);
  const double cell = 0.01 * box.diagonal();
  if (!(cell > 0)) return;
  for (const double shift : {0.0, 0.5}) {
    KeyIndex cells;
    std::vector<Index> first;
    for (const Index vertex : rims) {
      const Vec3 place = (surface.positions[at(vertex)] - box.min) / cell + Vec3::Constant(shift);
      std::uint64_t key = 0;
      for (int k = 0; k < 3; ++k) key = key << 10 | static_cast<std::uint64_t>(place[k]);
      const auto [index, is_new] = cells.insert(key);
      if (is_new) first.push_back(vertex);
      sets.join(first[at(index)], vertex);
    }
  }
}

}  // namespace

bool SurfacePart::is_flat() const {
  constexpr double kFlat = 1e-6;  // of the area to the power of 3/2; a ball has 0.094
  return std::abs(volume) <= kFlat * std::pow(area, 1.5);
}

std::string SurfacePart::place() const {
  const Vec3 center = box.center();
  return fmt::format("{} near ({:.4g}, {:.4g}, {:.4g})", name, center[0], center[1], center[2]);
}

double SurfaceParts::area() const {
  double sum = 0;
  for (const SurfacePart& part : parts) sum += part.area;
  return sum;
}

double SurfaceParts::volume() const {
  double sum = 0;
  for (const SurfacePart& part : parts) sum += part.volume;
  return std::abs(sum);
}

SurfaceParts find_parts(const SurfaceMesh& surface) {
  const std::vector<Triangle> welded = welded_triangles(surface);
  DisjointSets sets(surface.positions.size());
  for (const Triangle& triangle : welded)
    for (std::size_t k = 1; k < 3; ++k) sets.join(triangle[0], triangle[k]);
  const std::vector<Index> rims = find_rims(welded);
  join_near_rims(surface, rims, sets);
  SurfaceParts found;
  std::vector<Index> number(surface.positions.size(), -1), first_vertices;
  found.triangle_parts.reserve(welded.size());
  for (const Triangle& triangle : welded) {
    Index& part = number[at(sets.root(triangle[0]))];
    if (part < 0) {
      part = static_cast<Index>(first_vertices.size());
      first_vertices.push_back(triangle[0]);
    }
    found.triangle_parts.push_back(part);
  }
  found.parts.resize(first_vertices.size());
  for (const Index vertex : rims) found.parts[at(number[at(sets.root(vertex))])].open = true;
  measure_parts(surface, found);
  const std::vector<Index> groups = first_groups(surface);
  for (std::size_t p = 0; p < found.parts.size(); ++p) {
    const Index first = groups.empty() ? -1 : groups[at(first_vertices[p])];
    const std::string group = first < 0 ? "" : surface.groups[at(first)].name;
    found.parts[p].name = fmt::format("part {} of {} ({}{} triangles)", p + 1, found.parts.size(),
                                      group.empty() ? "" : "group '" + group + "', ", found.parts[p].triangles);
  }
  return found;
}

SurfaceParts find_shells(const SurfaceMesh& surface) {
  const std::vector<Triangle> welded = welded_triangles(surface);
  const std::vector<HalfEdge> sides = sorted_half_edges(welded);
  DisjointSets sets(welded.size());
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    if (edge.size() == 2) sets.join(edge[0].triangle, edge[1].triangle);
  });
  SurfaceParts found;
  std::vector<Index> number(welded.size(), -1);
  for (std::size_t t = 0; t < welded.size(); ++t) {
    found.triangle_parts.push_back(-1);
    if (is_collapsed(welded[t])) continue;
    Index& shell = number[at(sets.root(static_cast<Index>(t)))];
    if (shell < 0) {
      shell = static_cast<Index>(found.parts.size());
      found.parts.emplace_back();
    }
    found.triangle_parts.back() = shell;
  }
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    if (!is_balanced(edge))
      for (const HalfEdge& side : edge) found.parts[at(found.triangle_parts[at(side.triangle)])].open = true;
  });
  measure_parts(surface, found);
  return found;
}

Index find_sheet(const SurfaceMesh& surface, const SurfaceParts& parts) {
  constexpr std::size_t kSamples = 64;  // of a part
  constexpr double kOffset = 1e-4;      // of the box's diagonal
  constexpr double kBothSides = 0.3;    // a plane has 0.5, a closed surface 0
  if (std::none_of(parts.parts.begin(), parts.parts.end(), [](const SurfacePart& part) { return part.open; }))
    return -1;
  const WindingNumber winding(surface.positions, surface.triangles);
  const double offset = kOffset * used_bounds(surface).diagonal();
  std::vector<std::size_t> seen(parts.parts.size(), 0), sampled(parts.parts.size(), 0);
  std::vector<double> sums(parts.parts.size(), 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const std::size_t part = at(parts.triangle_parts[t]);
    const std::size_t stride = static_cast<std::size_t>(parts.parts[part].triangles) / kSamples + 1;
    if (!parts.parts[part].open || seen[part]++ % stride != 0) continue;
    std::array<Vec3, 3> x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = surface.positions[at(surface.triangles[t][k])];
    const Vec3 area = (x[1] - x[0]).cross(x[2] - x[0]), middle = (x[0] + x[1] + x[2]) / 3;
    if (!(area.norm() > 0)) continue;
    const Vec3 out = offset * area.normalized();
    sums[part] += std::min(std::abs(winding(middle + out)), std::abs(winding(middle - out)));
    ++sampled[part];
  }
  for (std::size_t part = 0; part < sums.size(); ++part)
    if (sums[part] > kBothSides * static_cast<double>(sampled[part])) return static_cast<Index>(part);
  return -1;
}

}  // namespace softreel
