#include "core/mesh/polygon_triangulation.h"

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

/// Clips ears off a polygon in the plane, kept as a ring of corners.
class EarClipper {
 public:
  explicit EarClipper(std::vector<Vec2> points) : p_(std::move(points)), next_(p_.size()), previous_(p_.size()) {
    const std::size_t n = p_.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    reflex_.resize(n);
    for (std::size_t i = 0; i < n; ++i) reflex_[i] = turn(i) <= 0;
  }

  std::vector<Triangle> clip() {
    std::vector<Triangle> triangles;
    std::size_t left = p_.size(), at = 0, refused = 0;
    while (left > 3) {
      // Where no corner is an ear (crossing or flat polygons), the corner at hand is cut off all the same.
      if (refused < left && !is_ear(at)) {
        at = next_[at];
        ++refused;
        continue;
      }
      triangles.push_back(corner_triangle(at));
      at = cut_off(at);
      --left;
      refused = 0;
    }
    triangles.push_back(corner_triangle(at));
    return triangles;
  }

 private:
  double turn(std::size_t i) const { return cross2(p_[i] - p_[previous_[i]], p_[next_[i]] - p_[i]); }

  Triangle corner_triangle(std::size_t i) const {
    return {static_cast<Index>(previous_[i]), static_cast<Index>(i), static_cast<Index>(next_[i])};
  }

  /// Convex, and no reflex corner of the ring inside its triangle. Corners at the triangle's own points do not count,
  /// so that keyhole polygons, which pass twice through a point, can be cut.
  bool is_ear(std::size_t i) const {
    if (reflex_[i]) return false;
    const std::size_t before = previous_[i], after = next_[i];
    const Vec2 &a = p_[before], &b = p_[i], &c = p_[after];
    for (std::size_t j = next_[after]; j != before; j = next_[j]) {
      if (!reflex_[j]) continue;
      const Vec2& q = p_[j];
      if (q == a || q == b || q == c) continue;
      if (cross2(b - a, q - a) >= 0 && cross2(c - b, q - b) >= 0 && cross2(a - c, q - c) >= 0) return false;
    }
    return true;
  }

  /// Takes corner i out of the ring. Goes on two corners further: strips instead of fans of slivers.
  std::size_t cut_off(std::size_t i) {
    const std::size_t before = previous_[i], after = next_[i];
    next_[before] = after;
    previous_[after] = before;
    reflex_[before] = turn(before) <= 0;
    reflex_[after] = turn(after) <= 0;
    return next_[after];
  }

  std::vector<Vec2> p_;
  std::vector<std::size_t> next_, previous_;
  std::vector<char> reflex_;
};

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
  const bool has_textures = !polygons.corner_textures.empty();
  mesh.triangles.clear();
  mesh.triangle_polygon.clear();
  mesh.triangle_textures.clear();
  std::int64_t dropped = 0;
  std::vector<Vec3> corners;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    const auto begin = static_cast<std::size_t>(polygons.offsets[p]);
    const auto end = static_cast<std::size_t>(polygons.offsets[p + 1]);
    corners.clear();
    bool finite = true;
    for (std::size_t c = begin; c < end; ++c) {
      corners.push_back(mesh.positions[static_cast<std::size_t>(polygons.corner_vertices[c])]);
      finite = finite && corners.back().allFinite();
    }
    if (!finite) {
      ++dropped;
      continue;
    }
    const auto pick = [&](const std::vector<Index>& of_corner, const Triangle& local) {
      Triangle picked;
      for (std::size_t k = 0; k < 3; ++k) picked[k] = of_corner[begin + static_cast<std::size_t>(local[k])];
      return picked;
    };
    for (const Triangle& local : triangulate_polygon(corners)) {
      mesh.triangles.push_back(pick(polygons.corner_vertices, local));
      mesh.triangle_polygon.push_back(static_cast<Index>(p));
      if (has_textures) mesh.triangle_textures.push_back(pick(polygons.corner_textures, local));
    }
  }
  return dropped;
}

}  // namespace softreel
