#include "core/tetmesh/cells/cell_triangles.h"

#include <cmath>
#include <utility>

#include "core/tetmesh/cells/cell_clipping.h"

namespace softreel {

const std::vector<CellTriangles::Polygon>& CellTriangles::polygons() {
  if (!polygons_.empty()) return polygons_;
  std::array<Vec3, 4> x;
  const std::array<LatticeNode, 4> nodes = cell_corners(cell_);
  for (std::size_t k = 0; k < 4; ++k) x[k] = Vec3(nodes[k][0], nodes[k][1], nodes[k][2]);
  for (const CellCut& cut : cuts_) {
    const ClippedTriangle clipped = clip_to_cell(triangle_weights(surface_, cut.triangle, cell_));
    Polygon polygon;
    for (std::size_t k = 0; k < clipped.count; ++k) {
      const Vec4& w = clipped.corners[k];
      polygon.push_back(w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3]);
    }
    polygons_.push_back(std::move(polygon));
  }
  return polygons_;
}

double CellTriangles::meet(std::size_t cut, const Vec3& a, const Vec3& d) const {
  const Vec3 u = corner(cut, 1) - corner(cut, 0), v = corner(cut, 2) - corner(cut, 0), s = a - corner(cut, 0);
  const Vec3 p = d.cross(v), q = s.cross(u);
  const double determinant = u.dot(p);
  if (determinant == 0) return -1;
  const double x = s.dot(p) / determinant, y = d.dot(q) / determinant;
  return x < 0 || y < 0 || x + y > 1 ? -1 : v.dot(q) / determinant;
}

bool CellTriangles::passes(const Bounds& box, const Vec3& a, const Vec3& d, double end) {
  constexpr double kMargin = 1e-6;  // far above round-off and above the shortest way that counts
  double from = 0, to = end;
  for (Index k = 0; k < 3; ++k) {
    const double low = box.min[k] - kMargin - a[k], high = box.max[k] + kMargin - a[k];
    if (d[k] == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double in = (d[k] > 0 ? low : high) / d[k], out = (d[k] > 0 ? high : low) / d[k];
    from = std::max(from, in);
    to = std::min(to, out);
  }
  return from <= to;
}

const BoxTree& CellTriangles::tree() {
  if (!tree_) {
    std::vector<Bounds> boxes(cuts_.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for (const Vec3& x : polygons()[i]) boxes[i].add(x);
    tree_.emplace(boxes);
  }
  return *tree_;
}

std::vector<std::size_t> CellTriangles::find_nearest(const Vec3& p, double slack) {
  if (!fans_) {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles;
    for (const Polygon& polygon : polygons()) {
      const auto first = static_cast<Index>(points.size()), last = first + static_cast<Index>(polygon.size()) - 1;
      points.insert(points.end(), polygon.begin(), polygon.end());
      for (Index v = first + 1; v <= std::max(last - 1, first + 1); ++v)
        triangles.push_back({first, std::min(v, last), std::min(v + 1, last)});
    }
    fans_.emplace(points, triangles);
  }
  const double reach = std::sqrt(fans_->nearest(p).squared_distance) + slack;
  std::vector<std::size_t> found;
  tree().visit_near({p, p}, reach, [&](Index i) { found.push_back(at(i)); });
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace softreel
