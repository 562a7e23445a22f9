/// The triangles in one lattice tetrahedron: what of them lies there, and which of them a line through it meets.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh/box_tree.h"
#include "core/tetmesh/cells/cut_cells.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

/// Borrows the surface and the cuts. Numbers of triangles are those of the cuts; lengths are in lattice units.
class CellTriangles {
 public:
  using Polygon = std::vector<Vec3>;

  CellTriangles(const LatticeSurface& surface, const BccCell& cell, std::span<const CellCut> cuts)
      : surface_(surface), cell_(cell), cuts_(cuts) {}

  const Vec3& corner(std::size_t cut, std::size_t k) const {
    return surface_.points[at(surface_.triangles[at(cuts_[cut].triangle)][k])];
  }
  Vec3 normal(std::size_t cut) const {
    return (corner(cut, 1) - corner(cut, 0)).cross(corner(cut, 2) - corner(cut, 0)).normalized();
  }

  /// What of each lies in the cell, convex.
  const std::vector<Polygon>& polygons();

  /// Where the line from a along d meets a triangle, in multiples of d; below 0 if it does not.
  double meet(std::size_t cut, const Vec3& a, const Vec3& d) const;

  /// Calls visit(cut) at least for those that the line from a, a point of the cell, meets within the cell before `end`,
  /// in multiples of d. The visitor may bring the end nearer. Cost: in a crowded cell logarithmic, and what is visited.
  template <typename Visit>
  void visit_along(const Vec3& a, const Vec3& d, const double& end, const Visit& visit) {
    if (cuts_.size() <= kFew) {
      for (std::size_t i = 0; i < cuts_.size(); ++i) visit(i);
      return;
    }
    tree().visit([&](const Bounds& box) { return passes(box, a, d, end); },
                 [&](Index i) { visit(static_cast<std::size_t>(i)); });
  }

  /// Calls visit(cut), in ascending order, at least for those that are at most `slack` further from a point than the
  /// nearest is. Cost: as that of lines.
  template <typename Visit>
  void visit_nearest(const Vec3& p, double slack, const Visit& visit) {
    if (cuts_.size() <= kFewNear) {
      for (std::size_t i = 0; i < cuts_.size(); ++i) visit(i);
      return;
    }
    for (const std::size_t i : find_nearest(p, slack)) visit(i);
  }

 private:
  /// So many are looked at one by one: a tree of them would take longer.
  static constexpr std::size_t kFew = 32, kFewNear = 256;

  /// Whether a line passes a box, with a margin.
  static bool passes(const Bounds& box, const Vec3& a, const Vec3& d, double end);
  const BoxTree& tree();
  std::vector<std::size_t> find_nearest(const Vec3& p, double slack);

  const LatticeSurface& surface_;
  BccCell cell_;
  std::span<const CellCut> cuts_;
  std::vector<Polygon> polygons_;
  std::optional<BoxTree> tree_;       ///< of the polygons, once a line was asked for
  std::optional<TriangleTree> fans_;  ///< the polygons as fans of triangles, once a point was asked for
};

}  // namespace softreel
