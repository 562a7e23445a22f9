#include "core/tetmesh/cells/cell_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/point_tree.h"
#include "core/tetmesh/cells/cell_triangles.h"
#include "core/tetmesh/surface/signed_distance.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

/// A point counts as inside if the surface goes round it more than this often (signed_distance.h).
constexpr double kInsideWinding = 0.5;

/// Shortest way that counts, lattice units: far above round-off, far below anything a surface means.
constexpr double kShort = 1e-7;

const Vec4 kMiddle = Vec4::Constant(0.25);

/// How many triangles of a patch look for others; spread over the patch.
constexpr std::size_t kProbes = 16;

/// So many points inside all look for each other; of more each looks for so many of the next ones.
constexpr std::size_t kFewPoints = 300, kNextPoints = 24;

/// Points (i + 1/4, ...) / 6 of all i, j, k, l with sum 5: their steps, for neighbours.
constexpr int kGridSum = 5;
struct GridPoint {
  std::array<int, 4> steps;
  Vec4 weights;
};

std::vector<GridPoint> make_grid() {
  std::vector<GridPoint> grid;
  for (int i = 0; i <= kGridSum; ++i)
    for (int j = 0; i + j <= kGridSum; ++j)
      for (int k = 0; i + j + k <= kGridSum; ++k) {
        const std::array<int, 4> steps{i, j, k, kGridSum - i - j - k};
        grid.push_back({steps, (Vec4(steps[0], steps[1], steps[2], steps[3]).array() + 0.25) / (kGridSum + 1)});
      }
  CHECK(grid.size() == kFillSamples);
  return grid;
}

const std::vector<GridPoint>& sample_grid() {
  static const std::vector<GridPoint> grid = make_grid();
  return grid;
}

bool are_neighbors(const GridPoint& p, const GridPoint& q) {
  int moved = 0;
  for (std::size_t k = 0; k < 4; ++k) moved += std::abs(p.steps[k] - q.steps[k]);
  return moved == 2;
}

/// A point inside the solid, the winding number there, and the triangle of the cell that is nearest.
struct InnerPoint {
  Vec3 point;
  double winding;
  std::size_t nearest;
};

/// The surface in one cell, as far as parts need it.
class CellSurface {
 public:
  /// inside: null will do for nearest_cut.
  CellSurface(const LatticeSurface& surface, const SolidInside* inside, const BccCell& cell,
              std::span<const CellCut> cuts)
      : surface_(surface),
        inside_(inside),
        cell_(cell),
        cuts_(cuts),
        triangles_(surface, cell, cuts),
        patches_(cuts.size()),
        patch_count_(cuts.size()) {
    const std::array<LatticeNode, 4> corners = cell_corners(cell);
    for (std::size_t k = 0; k < 4; ++k) corners_[k] = Vec3(corners[k][0], corners[k][1], corners[k][2]);
    join_sides();
  }

  CellParts find(std::span<Index> cut_parts) {
    if (patch_count_ > 1) join_through_solid();
    CellParts parts;
    parts.count = number_parts(cut_parts);
    const std::array<LatticeNode, 4> corners = cell_corners(cell_);
    for (std::size_t k = 0; k < 4; ++k)
      if (inside_->contains(corners[k])) parts.corners[k] = parts.count == 1 ? 0 : cut_parts[nearest_cut(corners_[k])];
    if (!measure_exactly(cut_parts, parts)) measure_by_samples(cut_parts, parts);
    return parts;
  }

  /// The clipped triangle nearest to a point of the cell: the way there crosses no other. Of those equally near, as
  /// where two bodies touch, one whose inner side faces the point.
  std::size_t nearest_cut(const Vec3& p) {
    std::size_t best = 0;
    double least = 1e300;
    bool best_behind = false;
    triangles_.visit_nearest(p, 4 * kShort, [&](std::size_t i) {
      const Polygon& x = polygons()[i];
      for (std::size_t k = 2; k < std::max<std::size_t>(x.size(), 3); ++k) {
        const Vec3 near = nearest_on_triangle(p, x[0], x[std::min(k - 1, x.size() - 1)], x[std::min(k, x.size() - 1)]);
        const double distance = (near - p).norm();
        const bool behind = normal(i).dot(p - near) < 0;
        const bool equal = std::abs(distance - least) < kShort;
        if (!(distance < least - kShort) && !(equal && behind && !best_behind)) continue;
        best = i;
        least = distance;
        best_behind = behind;
      }
    });
    return best;
  }

 private:
  using Polygon = CellTriangles::Polygon;

  void join(std::size_t i, std::size_t j) {
    if (joined(i, j)) return;
    patches_.join(static_cast<Index>(i), static_cast<Index>(j));
    --patch_count_;
  }
  bool joined(std::size_t i, std::size_t j) {
    return patches_.root(static_cast<Index>(i)) == patches_.root(static_cast<Index>(j));
  }

  /// Triangles whose common edge passes the cell; and the loose ends of one part of an open surface, which are only as
  /// exact as whoever made them.
  void join_sides() {
    std::vector<std::pair<std::int64_t, std::size_t>> sides;
    for (std::size_t i = 0; i < cuts_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        if (((cuts_[i].sides >> k) & 1) == 0) continue;
        const std::size_t t = at(cuts_[i].triangle);
        sides.emplace_back(surface_.joints[t][k], i);
        if (((surface_.rims[t] >> k) & 1) != 0) sides.emplace_back(-1 - std::int64_t{surface_.parts[t]}, i);
      }
    std::sort(sides.begin(), sides.end());
    for (std::size_t s = 1; s < sides.size(); ++s)
      if (sides[s].first == sides[s - 1].first) join(sides[s].second, sides[s - 1].second);
  }

  Index number_parts(std::span<Index> cut_parts) {
    Index count = 0;
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      const auto root = at(patches_.root(static_cast<Index>(i)));
      cut_parts[i] = root == i ? count++ : cut_parts[root];  // a root is the first of its patch
    }
    return std::max<Index>(count, 1);  // without triangles: all of it
  }

  Vec3 point_at(const Vec4& weights) const {
    return weights[0] * corners_[0] + weights[1] * corners_[1] + weights[2] * corners_[2] + weights[3] * corners_[3];
  }

  Vec3 normal(std::size_t cut) const { return triangles_.normal(cut); }
  const std::vector<Polygon>& polygons() { return triangles_.polygons(); }

  /// Whether one goes from one inner point to another without leaving the solid: each crossing of the surface takes one
  /// turn away or gives one.
  bool sees(const InnerPoint& from, const Vec3& to) {
    const Vec3 d = to - from.point;
    const double length = d.norm();
    std::vector<std::pair<double, int>> crossings;
    triangles_.visit_along(from.point, d, 1, [&](std::size_t i) {
      const double t = triangles_.meet(i, from.point, d);
      if (t * length > kShort && (1 - t) * length > kShort) crossings.emplace_back(t, normal(i).dot(d) > 0 ? -1 : 1);
    });
    std::sort(crossings.begin(), crossings.end());
    // Where the outside is no wider than round-off, as between bodies that touch, the way out still comes first.
    for (std::size_t i = 1; i < crossings.size(); ++i)
      if ((crossings[i].first - crossings[i - 1].first) * length < kShort && crossings[i].second < 0)
        std::swap(crossings[i], crossings[i - 1]);
    double winding = from.winding;
    for (const auto& [t, turn] : crossings) {
      winding += turn;
      if (std::abs(winding) < kInsideWinding) return false;
    }
    return true;
  }

  void join_through_solid() {
    std::vector<InnerPoint> points;
    probe(points);
    if (patch_count_ == 1) return;
    const std::size_t probed = points.size();
    std::vector<std::size_t> grid;
    for (std::size_t g = 0; g < kFillSamples; ++g) {
      const Vec3 p = point_at(sample_grid()[g].weights);
      const double winding = inside_->winding(p);
      if (std::abs(winding) < kInsideWinding) continue;
      points.push_back({p, winding, nearest_cut(p)});
      grid.push_back(g);
    }
    visit_pairs(points, [&](std::size_t i, std::size_t j) {
      if (joined(points[i].nearest, points[j].nearest)) return;
      const bool near = i < probed || are_neighbors(sample_grid()[grid[i - probed]], sample_grid()[grid[j - probed]]);
      if (near && sees(points[i], points[j].point)) join(points[i].nearest, points[j].nearest);
    });
  }

  /// Calls visit(i, j), i < j, for points that may see each other, until all patches are joined: all pairs if the
  /// points are few. In a crowd, as of gravel in one cell, most of them are in each other's way: the next ones.
  template <typename Visit>
  void visit_pairs(const std::vector<InnerPoint>& points, const Visit& visit) const {
    if (points.size() <= kFewPoints) {
      for (std::size_t i = 0; i < points.size() && patch_count_ > 1; ++i)
        for (std::size_t j = i + 1; j < points.size(); ++j) visit(i, j);
      return;
    }
    std::vector<Vec3> places;
    for (const InnerPoint& point : points) places.push_back(point.point);
    const PointTree tree(std::move(places));
    for (std::size_t i = 0; i < points.size() && patch_count_ > 1; ++i)
      for (const Index number : tree.nearest(points[i].point, kNextPoints))
        if (const std::size_t j = at(number); j != i) visit(std::min(i, j), std::max(i, j));
  }

  /// From triangles of each patch straight into the solid: to the next triangle, or to the end of the cell. In rounds
  /// of one a patch, until all are joined.
  void probe(std::vector<InnerPoint>& points) {
    std::vector<std::vector<std::size_t>> patches(cuts_.size());
    for (std::size_t i = 0; i < cuts_.size(); ++i) patches[at(patches_.root(static_cast<Index>(i)))].push_back(i);
    for (std::size_t round = 0; round < kProbes && patch_count_ > 1; ++round)
      for (const std::vector<std::size_t>& patch : patches) {
        if (round >= patch.size()) continue;
        const std::size_t i = patch[patch.size() <= kProbes ? round : round * patch.size() / kProbes];
        for (const double side : {-1.0, 1.0}) probe_from(i, side * normal(i), points);
      }
  }

  void probe_from(std::size_t cut, const Vec3& direction, std::vector<InnerPoint>& points) {
    if (!(direction.squaredNorm() > 0.5)) return;  // a triangle without area
    Vec3 start = Vec3::Zero();
    for (const Vec3& x : polygons()[cut]) start += x / static_cast<double>(polygons()[cut].size());
    if (normal(cut).dot(direction) > 0 && touches_another(cut, start)) return;  // what lies before it is the other's
    const double winding = inside_->winding(start + kShort * direction);
    if (std::abs(winding) < kInsideWinding) return;
    double end = std::max(way_out(start, direction), 4 * kShort);
    std::size_t hit = cut;
    triangles_.visit_along(start, direction, end, [&](std::size_t i) {
      const double t = triangles_.meet(i, start, direction);
      const bool is_first = t < end || (t == end && hit != cut && i < hit);
      if (t <= kShort || !is_first) return;
      end = t;
      hit = i;
    });
    if (hit != cut) join(cut, hit);
    points.push_back({start + 0.5 * end * direction, winding, cut});
  }

  /// Whether a triangle that is not joined to this one lies at a point of it.
  bool touches_another(std::size_t cut, const Vec3& point) {
    bool touches = false;
    triangles_.visit_along(point, normal(cut), kShort, [&](std::size_t i) {
      touches = touches || (!joined(i, cut) && std::abs(triangles_.meet(i, point, normal(cut))) < kShort);
    });
    return touches;
  }

  /// How far it is from a point of the cell to its end.
  double way_out(const Vec3& start, const Vec3& direction) const {
    const Vec4 weights = cell_weights(cell_, start), change = cell_weights(cell_, start + direction) - weights;
    double end = 1e300;
    for (Index k = 0; k < 4; ++k)
      if (change[k] < 0) end = std::min(end, std::max(0.0, weights[k] / -change[k]));
    return end;
  }

  /// Sums the shares of the triangles; false if that is not the volume of the parts.
  bool measure_exactly(std::span<const Index> cut_parts, CellParts& parts) const {
    for (const LatticeNode& node : cell_corners(cell_)) {
      const int winding = inside_->winding(node);
      if (winding != 0 && winding != 1) return false;
    }
    parts.fills.assign(at(parts.count), 0.0);
    if (cuts_.empty()) {
      parts.fills[0] = 1;
      return std::all_of(parts.corners.begin(), parts.corners.end(), [](Index part) { return part >= 0; });
    }
    if (parts.corners[3] >= 0) parts.fills[at(parts.corners[3])] = 1;
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      if ((surface_.rims[at(cuts_[i].triangle)] & cuts_[i].sides) != 0) return false;
      parts.fills[at(cut_parts[i])] += cuts_[i].volume_share;
    }
    constexpr double kRoundOff = 1e-7;
    if (parts.count == 1 && is_on_surface(corners_[3])) {  // whether corner 3 is inside hangs on round-off
      double& fill = parts.fills[0];
      fill -= std::floor(fill);
      if (std::min(fill, 1 - fill) < kRoundOff)
        fill = std::abs(inside_->winding(point_at(kMiddle))) < kInsideWinding ? 0 : 1;
    }
    for (double& fill : parts.fills) {
      if (fill < -kRoundOff || fill > 1 + kRoundOff) return false;
      fill = std::clamp(fill, 0.0, 1.0);
    }
    return true;
  }

  bool is_on_surface(const Vec3& p) const {
    return std::any_of(cuts_.begin(), cuts_.end(), [&](const CellCut& cut) {
      const Triangle& t = surface_.triangles[at(cut.triangle)];
      const std::vector<Vec3>& x = surface_.points;
      return (nearest_on_triangle(p, x[at(t[0])], x[at(t[1])], x[at(t[2])]) - p).norm() < kShort;
    });
  }

  void measure_by_samples(std::span<const Index> cut_parts, CellParts& parts) {
    parts.fills.assign(at(parts.count), 0.0);
    for (const GridPoint& point : sample_grid()) {
      const Vec3 p = point_at(point.weights);
      if (std::abs(inside_->quick_winding(p)) < kInsideWinding) continue;
      const Index part = parts.count == 1 ? 0 : cut_parts[nearest_cut(p)];
      parts.fills[at(part)] += 1.0 / static_cast<double>(kFillSamples);
    }
  }

  const LatticeSurface& surface_;
  const SolidInside* inside_;
  BccCell cell_;
  std::span<const CellCut> cuts_;
  CellTriangles triangles_;
  DisjointSets patches_;  ///< of cuts
  std::size_t patch_count_;
  std::array<Vec3, 4> corners_;
};

std::vector<Triangle> used_triangles(const LatticeSurface& surface) {
  std::vector<Triangle> used;
  used.reserve(surface.triangles.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (surface.used[t]) used.push_back(surface.triangles[t]);
  return used;
}

}  // namespace

SolidInside::SolidInside(const LatticeSurface& surface, const SurfaceMesh& mesh, const Threads& threads)
    : surface_(surface), winding_(mesh.positions, used_triangles(surface)) {
  const std::vector<Triangle> triangles = used_triangles(surface);
  if (surface.closed) {
    crossings_.emplace(mesh.positions, triangles, surface.frame);
    crossings_->visit_inside([&](const LatticeNode& node) { inside_.insert(node); });
  } else {
    const SurfaceDistance distance = measure_distance(mesh.positions, triangles, surface.frame, threads);
    for (std::size_t i = 0; i < distance.lattice.values.size(); ++i)
      if (distance.lattice.values[i] < 0) inside_.insert(distance.lattice.nodes.nodes()[i]);
  }
  inside_.number_nodes();
}

int SolidInside::winding(const LatticeNode& node) const {
  return crossings_ ? crossings_->winding(node) : contains(node) ? 1 : 0;
}

CellParts find_cell_parts(const LatticeSurface& surface, const SolidInside& inside, const BccCell& cell,
                          std::span<const CellCut> cuts, std::span<Index> cut_parts) {
  return CellSurface(surface, &inside, cell, cuts).find(cut_parts);
}

std::vector<std::size_t> nearest_cuts_in_cell(const LatticeSurface& surface, const BccCell& cell,
                                              std::span<const CellCut> cuts, std::span<const Vec3> points) {
  CellSurface triangles(surface, nullptr, cell, cuts);
  std::vector<std::size_t> nearest;
  for (const Vec3& point : points) nearest.push_back(triangles.nearest_cut(point));
  return nearest;
}

}  // namespace softreel
