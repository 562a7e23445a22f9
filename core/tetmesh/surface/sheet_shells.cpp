#include "core/tetmesh/surface/sheet_shells.h"

#include <array>
#include <cmath>
#include <vector>

#include "core/mesh/mesh_topology.h"

namespace softreel {
namespace {

Vec3 area_of(const SurfaceMesh& surface, const Triangle& t) {
  const Vec3& a = surface.positions[at(t[0])];
  return (surface.positions[at(t[1])] - a).cross(surface.positions[at(t[2])] - a);
}

/// Mean unit normals of the triangles at each vertex, up to sign: each triangle adds its own with the sign that agrees
/// with what is there already.
std::vector<Vec3> unsigned_normals(const SurfaceMesh& surface, const std::vector<Triangle>& sheets) {
  std::vector<Vec3> normals(surface.positions.size(), Vec3::Zero());
  for (const Triangle& t : sheets) {
    const Vec3 area = area_of(surface, t);
    if (!(area.norm() > 0)) continue;
    for (const Index v : t) normals[at(v)] += normals[at(v)].dot(area) < 0 ? Vec3(-area) : area;
  }
  for (Vec3& n : normals)
    if (const double length = n.norm(); length > 0) n /= length;
  return normals;
}

/// The two sides of each vertex, and the triangles between them.
class Skin {
 public:
  Skin(SurfaceMesh& surface, const std::vector<Vec3>& normals, double thickness)
      : surface_(surface), normals_(normals), half_(0.5 * thickness), first_side_(surface.positions.size(), -1) {}

  /// Both sides of a triangle, the upper one as it is.
  void add_sides(const Triangle& t) {
    const Vec3 area = area_of(surface_, t);
    const Triangle upper = side_of(t, area, true), lower = side_of(t, area, false);
    surface_.triangles.push_back(upper);
    surface_.triangles.push_back({lower[0], lower[2], lower[1]});
  }

  /// The wall over the side k of a triangle, facing away from it.
  void add_wall(const Triangle& t, std::size_t k) {
    const Vec3 area = area_of(surface_, t);
    const Triangle upper = side_of(t, area, true), lower = side_of(t, area, false);
    const std::size_t next = (k + 1) % 3;
    surface_.triangles.push_back({lower[k], lower[next], upper[next]});
    surface_.triangles.push_back({lower[k], upper[next], upper[k]});
  }

  /// Whether two triangles that share an edge, welded vertices low and high, meet at it on both sides. At a sharp fold
  /// they may take the one vertex's normal for the same side and the other's for different ones.
  bool go_on(const Triangle& s, const Triangle& t, Index low, Index high) {
    const std::array<Index, 2> upper = edge_of(s, low, high, true);
    const bool same = edge_of(t, low, high, true) == upper;
    return runs_forward(s, low, high) == runs_forward(t, low, high) ? edge_of(t, low, high, false) == upper : same;
  }

 private:
  static std::size_t corner_of(const Triangle& t, Index v) { return t[0] == v ? 0 : t[1] == v ? 1 : 2; }
  static bool runs_forward(const Triangle& t, Index low, Index high) { return t[(corner_of(t, low) + 1) % 3] == high; }
  std::array<Index, 2> edge_of(const Triangle& t, Index low, Index high, bool upper) {
    const Triangle side = side_of(t, area_of(surface_, t), upper);
    return {side[corner_of(t, low)], side[corner_of(t, high)]};
  }

  /// Corners of a triangle on the side that its own normal points to, or on the other one.
  Triangle side_of(const Triangle& t, const Vec3& area, bool upper) {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      Index& first = first_side_[at(t[k])];
      if (first < 0) {
        first = static_cast<Index>(surface_.positions.size());
        const Vec3 p = surface_.positions[at(t[k])], out = half_ * normals_[at(t[k])];
        surface_.positions.push_back(p + out);
        surface_.positions.push_back(p - out);
      }
      const bool agrees = normals_[at(t[k])].dot(area) >= 0;
      corners[k] = first + (agrees == upper ? 0 : 1);
    }
    return corners;
  }

  SurfaceMesh& surface_;
  const std::vector<Vec3>& normals_;
  double half_;
  std::vector<Index> first_side_;  ///< per vertex; -1 before there is one
};

}  // namespace

std::int64_t thicken_sheets(SurfaceMesh& surface, const SurfaceParts& parts, double thickness) {
  const std::vector<Triangle> welded = welded_triangles(surface);
  std::vector<Triangle> sheets, closed;
  for (std::size_t t = 0; t < welded.size(); ++t)
    if (!is_collapsed(welded[t]))
      (parts.parts[at(parts.triangle_parts[t])].open ? sheets : closed).push_back(welded[t]);
  if (sheets.empty()) return 0;
  const std::vector<Vec3> normals = unsigned_normals(surface, sheets);
  const std::vector<HalfEdge> sides = sorted_half_edges(sheets);
  SurfaceMesh thick;
  thick.positions = surface.positions;
  thick.triangles = std::move(closed);
  Skin skin(thick, normals, thickness);
  for (const Triangle& t : sheets) skin.add_sides(t);
  for_each_edge(std::span(sides), [&](std::span<const HalfEdge> edge) {
    const Triangle &first = sheets[at(edge[0].triangle)], &second = sheets[at(edge.back().triangle)];
    if (edge.size() == 2 && skin.go_on(first, second, edge[0].low, edge[0].high)) return;
    for (const HalfEdge& side : edge) {
      const Triangle& t = sheets[at(side.triangle)];
      for (std::size_t k = 0; k < 3; ++k)
        if (t[k] == (side.forward ? side.low : side.high) && t[(k + 1) % 3] == (side.forward ? side.high : side.low))
          skin.add_wall(t, k);
    }
  });
  surface = std::move(thick);
  return static_cast<std::int64_t>(sheets.size());
}

}  // namespace softreel
