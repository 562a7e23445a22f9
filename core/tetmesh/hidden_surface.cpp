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

/// Whether the solid is on both sides of a triangle's plane at one of its points.
class HiddenPoint {
 public:
  HiddenPoint(const WindingNumber& winding, double offset) : winding_(winding), offset_(offset) {}

  bool operator()(const Corners& x, const Vec3& p) const {
    const Vec3 area = (x[1] - x[0]).cross(x[2] - x[0]);
    if (!(area.norm() > 0)) return false;
    const Vec3 out = offset_ * area.normalized();
    return std::abs(winding_(p + out)) > kInside && std::abs(winding_(p - out)) > kInside;
  }

 private:
  const WindingNumber& winding_;
  double offset_;
};

/// Appends the pieces of a triangle that are not hidden; quarters it where its middle and its corners disagree.
void add_visible(const Corners& x, double step, int depth, const HiddenPoint& is_hidden,
                 std::vector<Corners>& visible) {
  const Vec3 middle = (x[0] + x[1] + x[2]) / 3;
  const bool hidden = is_hidden(x, middle);
  const double longest = std::max({(x[0] - x[1]).norm(), (x[1] - x[2]).norm(), (x[2] - x[0]).norm()});
  const bool agrees = std::all_of(
      x.begin(), x.end(), [&](const Vec3& corner) { return is_hidden(x, 0.95 * corner + 0.05 * middle) == hidden; });
  if (longest <= step || depth == kMaxQuarterings || agrees) {
    if (!hidden) visible.push_back(x);
    return;
  }
  const Vec3 ab = 0.5 * (x[0] + x[1]), bc = 0.5 * (x[1] + x[2]), ca = 0.5 * (x[2] + x[0]);
  for (const Corners& part : {Corners{x[0], ab, ca}, {ab, x[1], bc}, {ca, bc, x[2]}, {ab, bc, ca}})
    add_visible(part, step, depth + 1, is_hidden, visible);
}

}  // namespace

SurfaceMesh without_hidden(const SurfaceMesh& surface, const std::vector<std::uint8_t>& suspected, double step,
                           const Threads& threads) {
  SurfaceMesh visible;
  visible.positions = surface.positions;
  const WindingNumber winding(surface.positions, surface.triangles);
  const HiddenPoint is_hidden(winding, kOffset * used_bounds(surface).diagonal());
  const auto n = static_cast<std::int64_t>(surface.triangles.size());
  std::vector<std::vector<Corners>> chunks(static_cast<std::size_t>((n + kGrain - 1) / kGrain));
  threads.for_chunks(n, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      if (suspected[t] == 0) continue;
      Corners x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = surface.positions[static_cast<std::size_t>(surface.triangles[t][k])];
      add_visible(x, step, 0, is_hidden, chunks[static_cast<std::size_t>(begin / kGrain)]);
    }
  });
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (suspected[t] == 0) visible.triangles.push_back(surface.triangles[t]);
  for (const std::vector<Corners>& chunk : chunks)
    for (const Corners& piece : chunk) {
      const auto first = static_cast<Index>(visible.positions.size());
      visible.positions.insert(visible.positions.end(), piece.begin(), piece.end());
      visible.triangles.push_back({first, first + 1, first + 2});
    }
  return visible;
}

}  // namespace softreel
