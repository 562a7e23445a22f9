#include "core/tetmesh/cells/cell_clipping.h"

#include <algorithm>
#include <optional>

#include "core/base/check.h"

namespace softreel {
namespace {

/// Where a polygon crosses the face it is clipped by, and whether that is on face 1 too.
struct Crossing {
  Vec4 point = Vec4::Zero();
  bool on_1 = false;
};

/// The terms of the cuts with face 0 (ClippedTriangle::volume_share): one cut but for round-off.
class CutShare {
 public:
  void leave(const Crossing& crossing) { left_ = crossing; }
  void enter(const Crossing& crossing) {
    if (left_) {
      add(*left_, crossing);
      left_.reset();
    } else {
      first_enter_ = crossing;
    }
  }
  double sum() {
    if (left_ && first_enter_) add(*left_, *first_enter_);
    left_.reset();
    return sum_;
  }

 private:
  void add(const Crossing& leave, const Crossing& enter) {
    sum_ += enter.point[2] * leave.point[3] - enter.point[3] * leave.point[2];
    if (enter.on_1) sum_ += enter.point[3];
    if (leave.on_1) sum_ -= leave.point[3];
  }

  std::optional<Crossing> left_, first_enter_;
  double sum_ = 0;
};

/// From the inner end to the outer one, whichever way the polygon runs.
Vec4 cut_point(const Vec4& inner, const Vec4& outer, std::size_t face) {
  const auto f = static_cast<Index>(face);
  Vec4 point = inner + inner[f] / (inner[f] - outer[f]) * (outer - inner);
  point[f] = 0;
  return point;
}

/// Sutherland and Hodgman: keeps what has a weight of at least 0 in corner `face`. Returns the share of its cuts.
double clip(ClippedTriangle& polygon, std::size_t face) {
  ClippedTriangle kept;
  CutShare share;
  const auto f = static_cast<Index>(face);
  const auto add = [&](const Vec4& corner, std::uint8_t edge) {
    CHECK(kept.count < ClippedTriangle::kMostCorners);
    kept.corners[kept.count] = corner;
    kept.edges[kept.count++] = edge;
  };
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vec4 &from = polygon.corners[i], &to = polygon.corners[(i + 1) % polygon.count];
    const std::uint8_t edge = polygon.edges[i];
    const bool from_in = from[f] >= 0, to_in = to[f] >= 0;
    if (from_in) add(from, edge);
    if (from_in && !to_in) {
      const Crossing crossing{cut_point(from, to, face), edge == 1};
      share.leave(crossing);
      add(crossing.point, static_cast<std::uint8_t>(face));
    } else if (!from_in && to_in) {
      const Crossing crossing{cut_point(to, from, face), edge == 1};
      share.enter(crossing);
      add(crossing.point, edge);
    }
  }
  polygon = kept;
  return share.sum();
}

double determinant(const Vec4& a, const Vec4& b, const Vec4& c) {
  return a.tail<3>().dot(b.tail<3>().cross(c.tail<3>()));
}

}  // namespace

bool ClippedTriangle::has(std::uint8_t edge) const {
  return std::find(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(count), edge) !=
         edges.begin() + static_cast<std::ptrdiff_t>(count);
}

ClippedTriangle clip_to_cell(const std::array<Vec4, 3>& weights) {
  ClippedTriangle polygon;
  for (Index f = 0; f < 4; ++f)
    if (weights[0][f] < -kCellMargin && weights[1][f] < -kCellMargin && weights[2][f] < -kCellMargin) return polygon;
  polygon.count = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    polygon.corners[k] = (weights[k] + Vec4::Constant(kCellMargin)) / (1 + 4 * kCellMargin);
    polygon.edges[k] = static_cast<std::uint8_t>(ClippedTriangle::kOwnEdge + k);
  }
  for (std::size_t face = 3; face > 0 && polygon.count > 0; --face) clip(polygon, face);
  if (polygon.count == 0) return polygon;
  double share = clip(polygon, 0);  // last: the cut with face 0 is whole then
  for (std::size_t i = 2; i < polygon.count; ++i)
    share += determinant(polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]);
  polygon.volume_share = share;
  return polygon;
}

}  // namespace softreel
