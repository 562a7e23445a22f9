#include "core/tetmesh/cells/cut_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/mesh/mesh_topology.h"
#include "core/tetmesh/surface/triangle_halves.h"

namespace softreel {
namespace {

constexpr std::int64_t kCutGrain = 256;

/// Which side of a triangle runs between two welded vertices.
std::size_t side_of(const Triangle& welded, const HalfEdge& half) {
  for (std::size_t k = 0; k < 3; ++k)
    if (std::minmax(welded[k], welded[(k + 1) % 3]) == std::minmax(half.low, half.high)) return k;
  return 0;
}

/// Numbers the sides that meet at one edge.
void join_edge(LatticeSurface& surface, const std::vector<Triangle>& welded, std::span<const HalfEdge> edge,
               Index& joints) {
  const bool rim = !is_balanced(edge);
  const bool plain = edge.size() == 2 && !rim;
  std::map<std::pair<Index, Index>, Index> ends;  // numbered in the order they come up
  const Index first = joints;
  for (const HalfEdge& half : edge) {
    const std::size_t k = side_of(welded[at(half.triangle)], half);
    const Triangle& triangle = surface.triangles[at(half.triangle)];
    const std::pair<Index, Index> own = std::minmax(triangle[k], triangle[(k + 1) % 3]);
    const auto number = static_cast<Index>(ends.size());
    const Index end = plain && number > 0 ? 0 : ends.emplace(own, number).first->second;
    surface.joints[at(half.triangle)][k] = first + end;
    if (rim) surface.rims[at(half.triangle)] |= static_cast<std::uint8_t>(1U << k);
  }
  joints += static_cast<Index>(ends.size());
  surface.closed = surface.closed && !rim;
}

/// Collects the cells whose boxes overlap that of a triangle; a large one is halved first, so that it does not fill the
/// whole of its box.
void find_candidates(const TriangleCorners& x, std::vector<std::uint64_t>& cells) {
  constexpr double kSmall = 6, kMargin = 1e-6;
  const Vec3 low = x[0].cwiseMin(x[1]).cwiseMin(x[2]).array() - kMargin;
  const Vec3 high = x[0].cwiseMax(x[1]).cwiseMax(x[2]).array() + kMargin;
  if ((high - low).maxCoeff() > kSmall) {
    for (const TriangleCorners& half : halved(x)) find_candidates(half, cells);
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    LatticeNode begin, end;
    for (std::size_t k = 0; k < 3; ++k) {  // along its axis a cell reaches from its centre 2 up, across it 1 either way
      const auto d = static_cast<Index>(k);
      const double below = k == axis ? 3 : 2, above = k == axis ? 1 : 0;
      begin[k] = 2 * static_cast<std::int32_t>(std::ceil(0.5 * (low[d] - below))) + 1;
      end[k] = 2 * static_cast<std::int32_t>(std::floor(0.5 * (high[d] - above))) + 1;
    }
    const auto a = static_cast<Index>((axis + 1) % 3), b = static_cast<Index>((axis + 2) % 3);
    for (std::int32_t i = begin[0]; i <= end[0]; i += 2)
      for (std::int32_t j = begin[1]; j <= end[1]; j += 2)
        for (std::int32_t k = begin[2]; k <= end[2]; k += 2) {
          const LatticeNode center{i, j, k};
          const double u = center[at(a)], v = center[at(b)];
          const std::array<bool, 4> reached{low[b] <= v, high[a] >= u, high[b] >= v, low[a] <= u};
          for (std::uint8_t edge = 0; edge < 4; ++edge)
            if (reached[edge]) cells.push_back(cell_key({center, static_cast<std::uint8_t>(4 * axis + edge)}));
        }
  }
}

void cut_triangle(const LatticeSurface& surface, Index triangle, std::vector<std::uint64_t>& candidates,
                  std::vector<CellCut>& cuts) {
  TriangleCorners x;
  for (std::size_t k = 0; k < 3; ++k) x[k] = surface.points[at(surface.triangles[at(triangle)][k])];
  candidates.clear();
  find_candidates(x, candidates);
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  for (const std::uint64_t key : candidates) {
    const std::array<Vec4, 3> weights = triangle_weights(surface, triangle, cell_of_key(key));
    const ClippedTriangle clipped = clip_to_cell(weights);
    if (clipped.count == 0) continue;
    CellCut cut{key, triangle};
    for (std::size_t k = 0; k < 4; ++k) cut.faces |= static_cast<std::uint8_t>(clipped.has_face(k) ? 1U << k : 0U);
    for (std::size_t k = 0; k < 3; ++k) {
      cut.sides |= static_cast<std::uint8_t>(clipped.has_edge(k) ? 1U << k : 0U);
      cut.points |= static_cast<std::uint8_t>(in_cell(weights[k]) ? 1U << k : 0U);
    }
    cut.volume_share = clipped.volume_share;
    cuts.push_back(cut);
  }
}

}  // namespace

LatticeSurface make_lattice_surface(const SurfaceMesh& surface, const SurfaceParts& parts, const LatticeFrame& frame) {
  LatticeSurface result;
  result.frame = frame;
  result.triangles = surface.triangles;
  result.parts = parts.triangle_parts;
  double volume = 0;
  for (const SurfacePart& part : parts.parts) volume += part.volume;
  if (volume < 0)
    for (Triangle& triangle : result.triangles) std::swap(triangle[1], triangle[2]);
  result.points.reserve(surface.positions.size());
  for (const Vec3& p : surface.positions) result.points.push_back((p - frame.origin) * (2.0 / frame.spacing));
  std::vector<Triangle> welded = welded_triangles(surface);
  if (volume < 0)
    for (Triangle& triangle : welded) std::swap(triangle[1], triangle[2]);
  result.joints.assign(welded.size(), {-1, -1, -1});
  result.rims.assign(welded.size(), 0);
  for (std::size_t t = 0; t < welded.size(); ++t) {
    const Triangle& triangle = result.triangles[t];
    result.used.push_back(!is_collapsed(welded[t]) && std::all_of(triangle.begin(), triangle.end(), [&](Index v) {
      return result.points[at(v)].allFinite();
    }));
  }
  const std::vector<HalfEdge> halves = sorted_half_edges(welded);
  Index joints = 0;
  for_each_edge(std::span(halves), [&](std::span<const HalfEdge> edge) { join_edge(result, welded, edge, joints); });
  return result;
}

std::array<Vec4, 3> triangle_weights(const LatticeSurface& surface, Index triangle, const BccCell& cell) {
  std::array<Vec4, 3> weights;
  for (std::size_t k = 0; k < 3; ++k)
    weights[k] = cell_weights(cell, surface.points[at(surface.triangles[at(triangle)][k])]);
  return weights;
}

std::vector<CellCut> cut_cells(const LatticeSurface& surface, const Threads& threads) {
  const auto n = static_cast<std::int64_t>(surface.triangles.size());
  std::vector<std::vector<CellCut>> chunks(static_cast<std::size_t>((n + kCutGrain - 1) / kCutGrain));
  threads.for_chunks(n, kCutGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint64_t> candidates;
    for (auto t = static_cast<Index>(begin); t < static_cast<Index>(end); ++t)
      if (surface.used[at(t)])
        cut_triangle(surface, t, candidates, chunks[static_cast<std::size_t>(begin / kCutGrain)]);
    chunks[static_cast<std::size_t>(begin / kCutGrain)].shrink_to_fit();
  });
  std::size_t count = 0;
  for (const auto& chunk : chunks) count += chunk.size();
  std::vector<CellCut> cuts;
  cuts.reserve(count);
  for (auto& chunk : chunks) {
    cuts.insert(cuts.end(), chunk.begin(), chunk.end());
    std::vector<CellCut>().swap(chunk);
  }
  std::sort(cuts.begin(), cuts.end(), [](const CellCut& a, const CellCut& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.triangle < b.triangle;
  });
  return cuts;
}

}  // namespace softreel
