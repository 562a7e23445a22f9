#include "core/tetmesh/hidden_surface.h"

#include <algorithm>
#include <cmath>

#include "core/tetmesh/winding_number.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 64;

/// Winding numbers are taken so far in front and behind, as a share of the box's diagonal.
constexpr double kOffset = 1e-5;

/// From this winding number on a point is inside; closed surfaces have integers, the rims of open ones about a half.
constexpr double kInside = 0.75;

/// A triangle is quartered so many times at most.
constexpr int kMaxQuarterings = 6;

using Corners = std::array<Vec3, 3>;

/// Appends the pieces of a triangle.
void quarter(const Corners& x, double step, int depth, std::vector<Corners>& pieces) {
  const double longest = std::max({(x[0] - x[1]).norm(), (x[1] - x[2]).norm(), (x[2] - x[0]).norm()});
  if (longest <= step || depth == kMaxQuarterings) {
    pieces.push_back(x);
    return;
  }
  const Vec3 ab = 0.5 * (x[0] + x[1]), bc = 0.5 * (x[1] + x[2]), ca = 0.5 * (x[2] + x[0]);
  for (const Corners& part : {Corners{x[0], ab, ca}, {ab, x[1], bc}, {ca, bc, x[2]}, {ab, bc, ca}})
    quarter(part, step, depth + 1, pieces);
}

}  // namespace

SurfaceMesh without_hidden(const SurfaceMesh& surface, const std::vector<std::uint8_t>& suspected, double step,
                           const Threads& threads) {
  SurfaceMesh visible;
  visible.positions = surface.positions;
  std::vector<Corners> pieces;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (suspected[t] == 0) {
      visible.triangles.push_back(surface.triangles[t]);
      continue;
    }
    Corners x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = surface.positions[static_cast<std::size_t>(surface.triangles[t][k])];
    quarter(x, step, 0, pieces);
  }
  if (pieces.empty()) return visible;
  const WindingNumber winding(surface.positions, surface.triangles);
  const double offset = kOffset * used_bounds(surface).diagonal();
  std::vector<std::uint8_t> hidden(pieces.size(), 0);
  threads.for_chunks(static_cast<std::int64_t>(pieces.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto p = static_cast<std::size_t>(begin); p < static_cast<std::size_t>(end); ++p) {
      const auto& [a, b, c] = pieces[p];
      const Vec3 area = (b - a).cross(c - a), middle = (a + b + c) / 3;
      if (!(area.norm() > 0)) continue;
      const Vec3 out = offset * area.normalized();
      hidden[p] = std::abs(winding(middle + out)) > kInside && std::abs(winding(middle - out)) > kInside ? 1 : 0;
    }
  });
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (hidden[p] != 0) continue;
    const auto first = static_cast<Index>(visible.positions.size());
    visible.positions.insert(visible.positions.end(), pieces[p].begin(), pieces[p].end());
    visible.triangles.push_back({first, first + 1, first + 2});
  }
  return visible;
}

}  // namespace softreel
