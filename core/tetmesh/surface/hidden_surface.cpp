#include "core/tetmesh/surface/hidden_surface.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/winding_number.h"
#include "core/tetmesh/surface/surface_pieces.h"

namespace softreel {
namespace {

/// Winding numbers are taken so far in front and behind, as a share of the box's diagonal.
constexpr double kShareOfSize = 1e-5;

/// From this winding number on a point is inside; closed surfaces have integers, the rims of open ones about a half.
constexpr double kHiddenWinding = 0.75;

/// Pieces of so many steps, or so large a share of the box's diagonal, are judged by their middles and corners.
constexpr double kTrustedSteps = 4, kTrustedShare = 1.0 / 128;
constexpr int kMostQuarterings = 10;

/// Whether the solid is on both sides of a triangle's plane at one of its points.
class HiddenPoint {
 public:
  HiddenPoint(const WindingNumber& winding, double offset) : winding_(winding), offset_(offset) {}

  bool operator()(const std::array<Vec3, 3>& x, const Vec3& p) const {
    const Vec3 area = (x[1] - x[0]).cross(x[2] - x[0]);
    if (!(area.norm() > 0)) return false;
    const Vec3 out = offset_ * area.normalized();
    return std::abs(winding_(p + out)) > kHiddenWinding && std::abs(winding_(p - out)) > kHiddenWinding;
  }

 private:
  const WindingNumber& winding_;
  double offset_;
};

}  // namespace

SurfaceMesh without_hidden(const SurfaceMesh& surface, const std::vector<std::uint8_t>& suspected, double step,
                           const Threads& threads) {
  const WindingNumber winding(surface.positions, surface.triangles);
  const double size = used_bounds(surface).diagonal();
  const HiddenPoint is_hidden(winding, kShareOfSize * size);
  const PieceSizes sizes{step, std::max(kTrustedSteps * step, kTrustedShare * size), kMostQuarterings};
  return without_pieces(surface.positions, surface.triangles, suspected, sizes, is_hidden, threads);
}

}  // namespace softreel
