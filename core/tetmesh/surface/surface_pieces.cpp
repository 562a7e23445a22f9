#include "core/tetmesh/surface/surface_pieces.h"

#include <algorithm>

namespace softreel {
namespace {

constexpr std::int64_t kPieceGrain = 64;

/// Cuts one triangle.
class TriangleCutter {
 public:
  TriangleCutter(const PieceRules& rules, const TriangleCorners& triangle, std::vector<TriangleCorners>& kept)
      : rules_(rules), triangle_(triangle), kept_(kept) {}

  void cut() { add_kept(triangle_, 0); }

 private:
  /// Appends the pieces of a piece that stay, and returns whether that is all of it.
  bool add_kept(const TriangleCorners& x, int depth) {
    if (is_judged_by_middle(x, depth)) {
      const bool stays = !rules_.leaves_out(x, middle_of(x));
      if (stays) kept_.push_back(x);
      return stays;
    }
    const std::size_t before = kept_.size();
    bool all = true;
    const Vec3 ab = 0.5 * (x[0] + x[1]), bc = 0.5 * (x[1] + x[2]), ca = 0.5 * (x[2] + x[0]);
    for (const TriangleCorners& part : {TriangleCorners{x[0], ab, ca}, {ab, x[1], bc}, {ca, bc, x[2]}, {ab, bc, ca}})
      all = add_kept(part, depth + 1) && all;
    if (!all) return false;
    kept_.resize(before);  // what stays in one piece is one
    kept_.push_back(x);
    return true;
  }

  bool is_judged_by_middle(const TriangleCorners& x, int depth) const {
    const double longest = std::max({(x[0] - x[1]).norm(), (x[1] - x[2]).norm(), (x[2] - x[0]).norm()});
    if (longest <= rules_.border || depth == rules_.most_quarterings) return true;
    if (rules_.may_differ && !rules_.may_differ(triangle_, x)) return true;
    if (longest > rules_.trusted) return false;
    const Vec3 middle = middle_of(x);
    const bool left_out = rules_.leaves_out(x, middle);
    return std::all_of(x.begin(), x.end(), [&](const Vec3& corner) {
      return rules_.leaves_out(x, 0.95 * corner + 0.05 * middle) == left_out;
    });
  }

  static Vec3 middle_of(const TriangleCorners& x) { return (x[0] + x[1] + x[2]) / 3; }

  const PieceRules& rules_;
  const TriangleCorners& triangle_;
  std::vector<TriangleCorners>& kept_;
};

}  // namespace

SurfaceMesh without_pieces(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const std::vector<std::uint8_t>& suspected, const PieceRules& rules,
                           const Threads& threads) {
  SurfaceMesh rest;
  rest.positions = points;
  const auto n = static_cast<std::int64_t>(triangles.size());
  std::vector<std::vector<TriangleCorners>> chunks(static_cast<std::size_t>((n + kPieceGrain - 1) / kPieceGrain));
  threads.for_chunks(n, kPieceGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      if (suspected[t] == 0) continue;
      TriangleCorners x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = points[static_cast<std::size_t>(triangles[t][k])];
      TriangleCutter(rules, x, chunks[static_cast<std::size_t>(begin / kPieceGrain)]).cut();
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
