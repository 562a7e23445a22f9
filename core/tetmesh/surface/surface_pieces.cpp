#include "core/tetmesh/surface/surface_pieces.h"

#include <algorithm>

namespace softreel {
namespace {

constexpr std::int64_t kPieceGrain = 64;

using TriangleCorners = std::array<Vec3, 3>;

/// Appends the pieces of a triangle that stay, and returns whether that is all of it; quarters it where its middle and
/// its corners disagree.
bool add_kept(const TriangleCorners& x, const PieceSizes& sizes, int depth, const LeavesOut& leaves_out,
              std::vector<TriangleCorners>& kept) {
  const Vec3 middle = (x[0] + x[1] + x[2]) / 3;
  const bool left_out = leaves_out(x, middle);
  const double longest = std::max({(x[0] - x[1]).norm(), (x[1] - x[2]).norm(), (x[2] - x[0]).norm()});
  const auto agrees = [&](const Vec3& corner) { return leaves_out(x, 0.95 * corner + 0.05 * middle) == left_out; };
  if (longest <= sizes.border || depth == sizes.most_quarterings ||
      (longest <= sizes.trusted && std::all_of(x.begin(), x.end(), agrees))) {
    if (!left_out) kept.push_back(x);
    return !left_out;
  }
  const std::size_t before = kept.size();
  bool all = true;
  const Vec3 ab = 0.5 * (x[0] + x[1]), bc = 0.5 * (x[1] + x[2]), ca = 0.5 * (x[2] + x[0]);
  for (const TriangleCorners& part : {TriangleCorners{x[0], ab, ca}, {ab, x[1], bc}, {ca, bc, x[2]}, {ab, bc, ca}})
    all = add_kept(part, sizes, depth + 1, leaves_out, kept) && all;
  if (!all) return false;
  kept.resize(before);  // what stays in one piece is one
  kept.push_back(x);
  return true;
}

}  // namespace

SurfaceMesh without_pieces(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const std::vector<std::uint8_t>& suspected, const PieceSizes& sizes,
                           const LeavesOut& leaves_out, const Threads& threads) {
  SurfaceMesh rest;
  rest.positions = points;
  const auto n = static_cast<std::int64_t>(triangles.size());
  std::vector<std::vector<TriangleCorners>> chunks(static_cast<std::size_t>((n + kPieceGrain - 1) / kPieceGrain));
  threads.for_chunks(n, kPieceGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      if (suspected[t] == 0) continue;
      TriangleCorners x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = points[static_cast<std::size_t>(triangles[t][k])];
      add_kept(x, sizes, 0, leaves_out, chunks[static_cast<std::size_t>(begin / kPieceGrain)]);
    }
  });
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (suspected[t] == 0) rest.triangles.push_back(triangles[t]);
  for (const std::vector<TriangleCorners>& chunk : chunks)
    for (const TriangleCorners& piece : chunk) {
      const auto first = static_cast<Index>(rest.positions.size());
      rest.positions.insert(rest.positions.end(), piece.begin(), piece.end());
      rest.triangles.push_back({first, first + 1, first + 2});
    }
  return rest;
}

}  // namespace softreel
