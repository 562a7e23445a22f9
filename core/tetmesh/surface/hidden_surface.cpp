#include "core/tetmesh/surface/hidden_surface.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/winding_number.h"
#include "core/tetmesh/surface/surface_pieces.h"
#include "core/tetmesh/triangle_tree.h"

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

bool is_beside_plane(const TriangleCorners& plane, const TriangleCorners& x, double margin) {
  const Vec3 normal = (plane[1] - plane[0]).cross(plane[2] - plane[0]).normalized();
  const auto height = [&](std::size_t k) { return normal.dot(x[k] - plane[0]); };
  const double a = height(0), b = height(1), c = height(2);
  return std::min({a, b, c}) > margin || std::max({a, b, c}) < -margin;
}

/// Whether a triangle of the surface comes within `margin` of a piece of another one, by the planes and boxes of both:
/// only there does the piece go from the outside into a solid. Those that share an edge with the triangle go on from
/// it.
bool is_crossed(const TriangleTree& tree, const TriangleCorners& triangle, const TriangleCorners& piece,
                double margin) {
  const Vec3 low = piece[0].cwiseMin(piece[1]).cwiseMin(piece[2]) - Vec3::Constant(margin);
  const Vec3 high = piece[0].cwiseMax(piece[1]).cwiseMax(piece[2]) + Vec3::Constant(margin);
  bool crossed = false;
  const auto meets = [&](const Vec3& min, const Vec3& max) {
    return !crossed && (min.array() <= high.array()).all() && (max.array() >= low.array()).all();
  };
  tree.visit(meets, [&](Index place) {
    const TriangleCorners other = tree.corners(place);
    const auto is_shared = [&](const Vec3& corner) {
      return std::find(triangle.begin(), triangle.end(), corner) != triangle.end();
    };
    if (std::count_if(other.begin(), other.end(), is_shared) >= 2) return;
    crossed = crossed || !(is_beside_plane(piece, other, margin) || is_beside_plane(other, piece, margin));
  });
  return crossed;
}

}  // namespace

SurfaceMesh without_hidden(const SurfaceMesh& surface, const std::vector<std::uint8_t>& suspected, double step,
                           const Threads& threads) {
  const WindingNumber winding(surface.positions, surface.triangles);
  const double size = used_bounds(surface).diagonal(), offset = kShareOfSize * size;
  const TriangleTree tree(surface.positions, surface.triangles);
  PieceRules rules;
  rules.leaves_out = HiddenPoint(winding, offset);
  rules.may_differ = [&](const TriangleCorners& triangle, const TriangleCorners& piece) {
    return is_crossed(tree, triangle, piece, 2 * offset);
  };
  rules.border = step;
  rules.trusted = std::max(kTrustedSteps * step, kTrustedShare * size);
  rules.most_quarterings = kMostQuarterings;
  return without_pieces(surface.positions, surface.triangles, suspected, rules, threads);
}

}  // namespace softreel
