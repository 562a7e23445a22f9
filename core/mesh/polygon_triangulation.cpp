#include "core/mesh/polygon_triangulation.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include <Eigen/Geometry>

#include "core/base/check.h"

namespace softreel {
namespace {

/// Twice the area vector of a polygon (Newell): its direction is the normal, whatever the shape.
Vec3 area_vector(std::span<const Vec3> corners) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  return sum;
}

std::vector<Triangle> cut_fan(Index corners) {
  std::vector<Triangle> triangles;
  for (Index i = 1; i + 1 < corners; ++i) triangles.push_back({0, i, i + 1});
  return triangles;
}

std::vector<Triangle> cut_quad(std::span<const Vec3> p) {
  const Vec3 normal = area_vector(p);
  const auto turns_left = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (p[b] - p[a]).cross(p[c] - p[a]).dot(normal) > 0;
  };
  const bool first_inside = turns_left(0, 1, 2) && turns_left(0, 2, 3);
  const bool second_inside = turns_left(0, 1, 3) && turns_left(1, 2, 3);
  const bool first_shorter = (p[2] - p[0]).squaredNorm() <= (p[3] - p[1]).squaredNorm();
  if (first_inside != second_inside ? first_inside : first_shorter) return {{0, 1, 2}, {0, 2, 3}};
  return {{0, 1, 3}, {1, 2, 3}};
}

double cross2(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Finds the corners in a part of the plane: those put in, in the cells of a grid over the whole polygon.
class CornerGrid {
 public:
  explicit CornerGrid(const std::vector<Vec2>& points)
      : p_(points), side_(static_cast<std::size_t>(std::sqrt(static_cast<double>(points.size() / kCornersPerCell)))) {
    side_ = std::max<std::size_t>(side_, 1);
    cells_.resize(side_ * side_);
    for (const Vec2& p : points) box_.extend(p);
  }

  void insert(std::size_t i) { cell_of(i).push_back(i); }

  void remove(std::size_t i) {
    std::vector<std::size_t>& cell = cell_of(i);
    *std::find(cell.begin(), cell.end(), i) = cell.back();
    cell.pop_back();
  }

  /// A corner that is_it(corner) accepts, out of the cells that `box` touches; kNone if there is none.
  template <typename IsIt>
  std::size_t find(const Eigen::AlignedBox2d& box, const IsIt& is_it) const {
    const std::size_t last_column = line_of(box.max(), 0), last_row = line_of(box.max(), 1);
    for (std::size_t row = line_of(box.min(), 1); row <= last_row; ++row)
      for (std::size_t column = line_of(box.min(), 0); column <= last_column; ++column)
        for (const std::size_t i : cells_[row * side_ + column])
          if (is_it(i)) return i;
    return kNone;
  }

 private:
  /// Few enough to be asked one by one; polygons of less than four times as many are one cell.
  static constexpr std::size_t kCornersPerCell = 16;

  /// Column (axis 0) or row (axis 1) of a point. A box without extent, or one that overflows, is all line 0.
  std::size_t line_of(const Vec2& p, int axis) const {
    const double line =
        (p[axis] - box_.min()[axis]) / (box_.max()[axis] - box_.min()[axis]) * static_cast<double>(side_);
    return line >= 1 ? std::min(static_cast<std::size_t>(line), side_ - 1) : 0;
  }
  std::vector<std::size_t>& cell_of(std::size_t i) { return cells_[line_of(p_[i], 1) * side_ + line_of(p_[i], 0)]; }

  const std::vector<Vec2>& p_;
  std::size_t side_;  ///< columns, and rows
  std::vector<std::vector<std::size_t>> cells_;
  Eigen::AlignedBox2d box_;
};

/// Clips ears off a polygon in the plane, kept as a ring of corners.
///
/// A corner that is no ear is not asked again before its neighbours change or the corner inside its triangle is gone:
/// else large polygons, whose corners mostly are none, would cost the square of their corners and more.
class EarClipper {
 public:
  explicit EarClipper(std::vector<Vec2> points)
      : p_(std::move(points)),
        next_(p_.size()),
        previous_(p_.size()),
        reflex_(p_.size(), false),
        unasked_(p_.size(), true),
        reflex_corners_(p_) {
    const std::size_t n = p_.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    for (std::size_t i = 0; i < n; ++i) set_reflex(i, turn(i) <= 0);
  }
  EarClipper(const EarClipper&) = delete;
  EarClipper& operator=(const EarClipper&) = delete;

  std::vector<Triangle> clip() {
    std::vector<Triangle> triangles;
    std::size_t at = 0;
    for (std::size_t left = p_.size(); left > 3; --left) {
      at = find_ear(at);
      triangles.push_back(corner_triangle(at));
      at = cut_off(at);
    }
    triangles.push_back(corner_triangle(at));
    return triangles;
  }

 private:
  double turn(std::size_t i) const { return cross2(p_[i] - p_[previous_[i]], p_[next_[i]] - p_[i]); }

  Triangle corner_triangle(std::size_t i) const {
    return {static_cast<Index>(previous_[i]), static_cast<Index>(i), static_cast<Index>(next_[i])};
  }

  /// The first ear on the way round from corner `at`. Where no corner is an ear (crossing or flat polygons), `at`
  /// itself: it is cut off all the same.
  std::size_t find_ear(std::size_t at) {
    for (std::size_t i = next_unasked(at); i != kNone; i = next_unasked(at))
      if (is_ear(i)) return i;
    return at;
  }

  /// The first unasked corner on the way round from `at`, which follows the numbers of the corners.
  std::size_t next_unasked(std::size_t at) const {
    const char* const flags = unasked_.data();
    const void* found = std::memchr(flags + at, true, unasked_.size() - at);
    if (found == nullptr) found = std::memchr(flags, true, at);
    return found == nullptr ? kNone : static_cast<std::size_t>(static_cast<const char*>(found) - flags);
  }

  /// Convex, and no reflex corner of the ring inside its triangle. Corners at the triangle's own points do not count,
  /// so that keyhole polygons, which pass twice through a point, can be cut.
  bool is_ear(std::size_t i) {
    unasked_[i] = false;
    if (reflex_[i]) return false;
    const Vec2 &a = p_[previous_[i]], &b = p_[i], &c = p_[next_[i]];
    const auto lies_inside = [&](std::size_t j) {
      const Vec2& q = p_[j];
      if (q == a || q == b || q == c) return false;
      return cross2(b - a, q - a) >= 0 && cross2(c - b, q - b) >= 0 && cross2(a - c, q - c) >= 0;
    };
    const std::size_t blocker = reflex_corners_.find(Eigen::AlignedBox2d(a).extend(b).extend(c), lies_inside);
    if (blocker != kNone) blocked_by_.emplace(blocker, i);
    return blocker == kNone;
  }

  /// Takes corner i out of the ring. Goes on two corners further: strips instead of fans of slivers.
  std::size_t cut_off(std::size_t i) {
    const std::size_t before = previous_[i], after = next_[i];
    next_[before] = after;
    previous_[after] = before;
    next_[i] = i;
    set_reflex(i, false);
    for (const std::size_t neighbour : {before, after}) {
      set_reflex(neighbour, turn(neighbour) <= 0);
      unasked_[neighbour] = true;
    }
    return next_[after];
  }

  void set_reflex(std::size_t i, bool reflex) {
    if ((reflex_[i] != 0) == reflex) return;
    reflex_[i] = reflex;
    if (reflex) {
      reflex_corners_.insert(i);
      return;
    }
    reflex_corners_.remove(i);
    const auto [first, last] = blocked_by_.equal_range(i);
    for (auto blocked = first; blocked != last; ++blocked)
      if (is_in_ring(blocked->second)) unasked_[blocked->second] = true;
    blocked_by_.erase(first, last);
  }

  bool is_in_ring(std::size_t i) const { return next_[i] != i; }

  std::vector<Vec2> p_;
  std::vector<std::size_t> next_, previous_;
  std::vector<char> reflex_, unasked_;
  CornerGrid reflex_corners_;
  std::multimap<std::size_t, std::size_t> blocked_by_;  ///< a reflex corner, and one that is no ear because of it
};

/// Adds one triangle of polygon p, given by its corners within the polygon.
void append_triangle(SurfaceMesh& mesh, std::size_t p, const Triangle& local) {
  const auto pick = [&](const std::vector<Index>& of_corner) {
    Triangle picked;
    for (std::size_t k = 0; k < 3; ++k)
      picked[k] = of_corner[static_cast<std::size_t>(mesh.polygons.offsets[p] + local[k])];
    return picked;
  };
  mesh.triangles.push_back(pick(mesh.polygons.corner_vertices));
  mesh.triangle_polygon.push_back(static_cast<Index>(p));
  if (!mesh.polygons.corner_textures.empty()) mesh.triangle_textures.push_back(pick(mesh.polygons.corner_textures));
}

}  // namespace

std::vector<Triangle> triangulate_polygon(std::span<const Vec3> corners) {
  CHECK(corners.size() >= 3U);
  if (corners.size() == 3) return {{0, 1, 2}};
  if (corners.size() == 4) return cut_quad(corners);
  const Vec3 normal = area_vector(corners);
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length)) return cut_fan(static_cast<Index>(corners.size()));
  const Vec3 u = (normal / length).unitOrthogonal(), v = (normal / length).cross(u);
  std::vector<Vec2> flat;
  flat.reserve(corners.size());
  for (const Vec3& p : corners) flat.emplace_back(u.dot(p - corners[0]), v.dot(p - corners[0]));
  return EarClipper(std::move(flat)).clip();
}

std::int64_t triangulate_polygons(SurfaceMesh& mesh) {
  const PolygonList& polygons = mesh.polygons;
  mesh.triangles.clear();
  mesh.triangle_polygon.clear();
  mesh.triangle_textures.clear();
  mesh.triangles.reserve(polygons.size());
  mesh.triangle_polygon.reserve(polygons.size());
  std::int64_t dropped = 0;
  std::vector<Vec3> corners;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    corners.clear();
    for (Index c = polygons.offsets[p]; c < polygons.offsets[p + 1]; ++c)
      corners.push_back(
          mesh.positions[static_cast<std::size_t>(polygons.corner_vertices[static_cast<std::size_t>(c)])]);
    if (!std::all_of(corners.begin(), corners.end(), [](const Vec3& q) { return q.allFinite(); })) {
      ++dropped;
    } else if (corners.size() == 3) {
      append_triangle(mesh, p, {0, 1, 2});
    } else {
      for (const Triangle& local : triangulate_polygon(corners)) append_triangle(mesh, p, local);
    }
  }
  return dropped;
}

}  // namespace softreel
