#include "core/tetmesh/stuffing/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/mesh/disjoint_sets.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"

namespace softreel {
namespace {

/// Reaches in spacings. A flat wall has a firm inside node within 1.1 of each of its points, a round tip within 1.5.
/// Most have one much nearer, which is looked for first.
constexpr double kLostReach = 1.6, kFillReach = 0.62, kUsualReach = 0.8;

/// Values of a node that is taken in and of the outside nodes round it, in spacings. The cut lies so near the middle of
/// both kinds of edges that neither end is warped.
constexpr double kTakenIn = -0.6, kNextToTakenIn = 0.5;

/// Each round closes at least half of every gap.
constexpr int kMaxRounds = 8;

/// The inside nodes that stuffing keeps inside, and which of them hang together along lattice edges.
class FirmNodes {
 public:
  explicit FirmNodes(const SurfaceDistance& distance) : distance_(distance), sets_(distance.lattice.values.size()) {
    const auto count = static_cast<Index>(distance.lattice.values.size());
    firm_.resize(at(count));
    for (Index i = 0; i < count; ++i) firm_[at(i)] = is_firm(i);
    for (Index i = 0; i < count; ++i) {
      if (!firm_[at(i)]) continue;
      for (std::size_t k = 0; k < kNeighbors; ++k)
        if (const Index j = neighbor(i, k); j > i && firm_[at(j)]) sets_.join(i, j);
    }
  }

  /// The set of the firm node nearest to `point` that belongs to the part (or lies deep inside); -1 if none is in
  /// reach.
  Index near(const Vec3& point, Index part, const SurfaceParts& parts) {
    for (const double reach : {kUsualReach, kLostReach})
      if (const Index nearest = nearest_firm(point, reach, part, parts); nearest >= 0) return sets_.root(nearest);
    return -1;
  }

  /// Parts that have firm nodes of their own; the others are lost as a whole, which is said by name elsewhere.
  std::vector<bool> carried_parts(const SurfaceParts& parts) const {
    std::vector<bool> carried(parts.parts.size());
    for (std::size_t i = 0; i < firm_.size(); ++i)
      if (const Index triangle = distance_.nearest_triangles[i]; firm_[i] && triangle >= 0)
        carried[at(parts.triangle_parts[at(triangle)])] = true;
    return carried;
  }

  /// Calls visit(node, distance in spacings) for all lattice nodes within `reach` spacings of a point.
  template <typename Visit>
  static void visit_nodes(const LatticeFrame& frame, const Vec3& point, double reach, const Visit& visit) {
    const Vec3 center = (point - frame.origin) * (2.0 / frame.spacing);
    std::array<std::int32_t, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = static_cast<std::int32_t>(std::ceil(center[static_cast<int>(k)] - 2 * reach));
      high[k] = static_cast<std::int32_t>(std::floor(center[static_cast<int>(k)] + 2 * reach));
    }
    const auto squared = [&](int axis, std::int32_t at) { return (at - center[axis]) * (at - center[axis]); };
    for (std::int32_t x = low[0]; x <= high[0]; ++x)
      for (std::int32_t y = low[1] + ((low[1] ^ x) & 1); y <= high[1]; y += 2) {
        const double beside = squared(0, x) + squared(1, y);
        if (beside > 4 * reach * reach) continue;
        for (std::int32_t z = low[2] + ((low[2] ^ x) & 1); z <= high[2]; z += 2)
          if (const double all = beside + squared(2, z); all <= 4 * reach * reach)
            visit(LatticeNode{x, y, z}, 0.5 * std::sqrt(all));
      }
  }

 private:
  Index nearest_firm(const Vec3& point, double reach, Index part, const SurfaceParts& parts) const {
    Index nearest = -1;
    double least = 1e300;
    visit_nodes(distance_.lattice.frame, point, reach, [&](const LatticeNode& node, double distance) {
      const Index i = distance < least ? distance_.lattice.nodes.find(node) : -1;
      if (i < 0 || !firm_[at(i)]) return;
      const Index triangle = distance_.nearest_triangles[at(i)];
      if (triangle >= 0 && parts.triangle_parts[at(triangle)] != part) return;
      least = distance;
      nearest = i;
    });
    return nearest;
  }

  Index neighbor(Index i, std::size_t k) const {
    return distance_.lattice.nodes.find(lattice_neighbor(distance_.lattice.nodes.nodes()[at(i)], k));
  }

  bool is_firm(Index i) const {
    const double inside = -distance_.lattice.values[at(i)];
    if (!(inside > 0)) return false;
    for (std::size_t k = 0; k < kNeighbors; ++k) {
      const Index j = neighbor(i, k);
      const double outside = j < 0 ? 0 : distance_.lattice.values[at(j)];
      if (outside >= 0 && inside < (k < kLongNeighbors ? kWarpLong : kWarpShort) * (inside + outside)) return false;
    }
    return true;
  }

  const SurfaceDistance& distance_;
  std::vector<bool> firm_;
  DisjointSets sets_;
};

/// Nodes to take in, with a triangle near each.
using TakenIn = std::map<LatticeNode, Index>;

/// Samples spread over a triangle: in rows parallel to its shortest side, from the opposite corner on, so that a sliver
/// takes few. Row i holds the samples 0 .. last(i).
class SampleGrid {
 public:
  /// Samples at most about `step` apart, m.
  SampleGrid(const std::array<Vec3, 3>& corners, double step) {
    std::array<double, 3> opposite;
    for (std::size_t k = 0; k < 3; ++k) opposite[k] = (corners[(k + 1) % 3] - corners[(k + 2) % 3]).norm();
    const auto shortest = std::min_element(opposite.begin(), opposite.end());
    const auto apex = static_cast<std::size_t>(shortest - opposite.begin());
    apex_ = corners[apex];
    first_ = corners[(apex + 1) % 3] - apex_;
    second_ = corners[(apex + 2) % 3] - apex_;
    const auto steps = [&](double length) { return std::max(1, static_cast<int>(std::ceil(length / step))); };
    rows_ = steps(*std::max_element(opposite.begin(), opposite.end()));
    columns_ = steps(*shortest);
  }

  int rows() const { return rows_; }
  int last(int row) const { return static_cast<int>((std::int64_t{columns_} * row + rows_ - 1) / rows_); }

  Vec3 point(int row, int place) const {
    const double down = static_cast<double>(row) / rows_;
    const double along = row == 0 ? 0.0 : static_cast<double>(place) / last(row);
    return apex_ + down * ((1 - along) * first_ + along * second_);
  }

  /// The place in another row, or in a row of another grid of the triangle, that lies as far along as this one.
  int facing(int row, int place, const SampleGrid& other, int other_row) const {
    if (last(row) == 0) return 0;
    return static_cast<int>((2 * std::int64_t{place} * other.last(other_row) + last(row)) / (2 * last(row)));
  }

  /// Calls visit(point, row, place).
  template <typename Visit>
  void visit_samples(const Visit& visit) const {
    for (int row = 0; row <= rows_; ++row)
      for (int place = 0; place <= last(row); ++place) visit(point(row, place), row, place);
  }

 private:
  Vec3 apex_, first_, second_;
  int rows_ = 1, columns_ = 1;
};

/// Finds, in one round, where the surface is lost or falls apart.
class Round {
 public:
  Round(const SurfaceDistance& distance, const SurfaceMesh& surface, const SurfaceParts& parts)
      : distance_(distance), surface_(surface), parts_(parts), firm_(distance) {}

  TakenIn find() {
    vertex_sets_.assign(surface_.positions.size(), kUnknown);
    const std::vector<bool> carried = firm_.carried_parts(parts_);
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t)
      if (carried[at(parts_.triangle_parts[t])]) visit(static_cast<Index>(t));
    return std::move(taken_in_);
  }

 private:
  static constexpr Index kUnknown = -2;

  const Vec3& corner(Index triangle, std::size_t k) const {
    return surface_.positions[at(surface_.triangles[at(triangle)][k])];
  }

  Index set_of_vertex(Index vertex, Index part) {
    Index& known = vertex_sets_[at(vertex)];
    if (known == kUnknown) known = firm_.near(surface_.positions[at(vertex)], part, parts_);
    return known;
  }

  void visit(Index triangle) {
    const Index part = parts_.triangle_parts[at(triangle)];
    const Triangle& corners = surface_.triangles[at(triangle)];
    const Index first = set_of_vertex(corners[0], part);
    bool torn = first < 0;
    for (std::size_t k = 1; k < 3; ++k) torn = set_of_vertex(corners[k], part) != first || torn;
    // Between corners that are far apart there may be gaps that no corner sees.
    if (const SampleGrid grid = samples(triangle, 1.0); !torn && grid.rows() > 1)
      grid.visit_samples([&](const Vec3& p, int, int) { torn = torn || firm_.near(p, part, parts_) != first; });
    if (torn) fill(triangle, part);
  }

  /// Samples at most `step` spacings apart.
  SampleGrid samples(Index triangle, double step) const {
    return {{corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)}, step * distance_.lattice.frame.spacing};
  }

  /// Where a triangle is lost or falls apart: samples without a firm node, or beside one of another set, and what lies
  /// within kWindow steps of them. By row and place.
  std::vector<std::vector<bool>> find_tears(Index part, const SampleGrid& grid) {
    constexpr int kWindow = 5;
    std::vector<std::vector<Index>> sets(at(grid.rows() + 1));
    std::vector<std::vector<bool>> near_tear(at(grid.rows() + 1));
    for (int i = 0; i <= grid.rows(); ++i) near_tear[at(i)].resize(at(grid.last(i) + 1), false);
    grid.visit_samples([&](const Vec3& p, int i, int) { sets[at(i)].push_back(firm_.near(p, part, parts_)); });
    const auto mark = [&](int i, int j) {
      for (int k = std::max(0, i - kWindow); k <= std::min(grid.rows(), i + kWindow); ++k) {
        const int middle = grid.facing(i, j, grid, k), beside = kWindow - std::abs(k - i);
        for (int l = std::max(0, middle - beside); l <= std::min(grid.last(k), middle + beside); ++l)
          near_tear[at(k)][at(l)] = true;
      }
    };
    for (int i = 0; i <= grid.rows(); ++i)
      for (int j = 0; j <= grid.last(i); ++j) {
        const Index own = sets[at(i)][at(j)];
        if (own < 0 || (j < grid.last(i) && sets[at(i)][at(j + 1)] != own) ||
            (i < grid.rows() && sets[at(i + 1)][at(grid.facing(i, j, grid, i + 1))] != own))
          mark(i, j);
      }
    return near_tear;
  }

  /// Takes in the nodes under a triangle where it tears: a little below the surface, where a thin part has its middle.
  void fill(Index triangle, Index part) {
    constexpr double kTearStep = 0.5, kStep = 0.12, kDepth = 0.25;
    const Vec3 &a = corner(triangle, 0), area = (corner(triangle, 1) - a).cross(corner(triangle, 2) - a);
    if (!(area.norm() > 0)) return;
    const Vec3 under = -kDepth * distance_.lattice.frame.spacing * area.normalized();
    const SampleGrid coarse = samples(triangle, kTearStep), fine = samples(triangle, kStep);
    if (coarse.rows() == 1) {  // torn as a whole
      fine.visit_samples([&](const Vec3& p, int, int) { take_in(p + under, triangle, part); });
      return;
    }
    const std::vector<std::vector<bool>> near_tear = find_tears(part, coarse);
    fine.visit_samples([&](const Vec3& p, int i, int j) {
      const auto row = static_cast<int>(std::int64_t{i} * coarse.rows() / fine.rows());
      if (near_tear[at(row)][at(fine.facing(i, j, coarse, row))]) take_in(p + under, triangle, part);
    });
  }

  void take_in(const Vec3& point, Index triangle, Index part) {
    FirmNodes::visit_nodes(distance_.lattice.frame, point, kFillReach, [&](const LatticeNode& node, double) {
      const Index i = distance_.lattice.nodes.find(node);
      const Index nearest = i < 0 ? -1 : distance_.nearest_triangles[at(i)];
      // Not across a gap to another part: parts stay apart where they are.
      if (nearest >= 0 && parts_.triangle_parts[at(nearest)] != part) return;
      taken_in_.try_emplace(node, triangle);
    });
  }

  const SurfaceDistance& distance_;
  const SurfaceMesh& surface_;
  const SurfaceParts& parts_;
  FirmNodes firm_;
  std::vector<Index> vertex_sets_;  ///< per vertex: set of its firm node, -1 none, kUnknown not asked yet
  TakenIn taken_in_;
};

/// The distance with the nodes taken in and with all their neighbours in the set.
SurfaceDistance with_nodes(const SurfaceDistance& old, const TakenIn& taken_in) {
  const double spacing = old.lattice.frame.spacing;
  SurfaceDistance changed;
  changed.lattice.frame = old.lattice.frame;
  changed.lattice.nodes = old.lattice.nodes;
  std::map<LatticeNode, Index> next_to;
  for (const auto& [node, triangle] : taken_in) {
    changed.lattice.nodes.insert(node);
    for (std::size_t k = 0; k < kNeighbors; ++k) {
      const LatticeNode neighbor = lattice_neighbor(node, k);
      changed.lattice.nodes.insert(neighbor);
      if (taken_in.count(neighbor) == 0) next_to.emplace(neighbor, triangle);
    }
  }
  changed.lattice.nodes.number_nodes();
  const std::vector<LatticeNode>& nodes = changed.lattice.nodes.nodes();
  changed.lattice.values.assign(nodes.size(), kNextToTakenIn * spacing);
  changed.nearest_triangles.assign(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (const Index before = old.lattice.nodes.find(nodes[i]); before >= 0) {
      changed.lattice.values[i] = old.lattice.values[at(before)];
      changed.nearest_triangles[i] = old.nearest_triangles[at(before)];
    }
    const auto taken = taken_in.find(nodes[i]);
    const auto next = next_to.find(nodes[i]);
    if (taken != taken_in.end()) changed.lattice.values[i] = std::min(changed.lattice.values[i], kTakenIn * spacing);
    if (next != next_to.end())
      changed.lattice.values[i] = std::min(changed.lattice.values[i], kNextToTakenIn * spacing);
    if (changed.nearest_triangles[i] < 0 && taken != taken_in.end()) changed.nearest_triangles[i] = taken->second;
    if (changed.nearest_triangles[i] < 0 && next != next_to.end()) changed.nearest_triangles[i] = next->second;
  }
  return changed;
}

}  // namespace

Index bridge_thin_parts(SurfaceDistance& distance, const SurfaceMesh& surface, const SurfaceParts& parts) {
  TakenIn all;
  for (int round = 0; round < kMaxRounds; ++round) {
    const TakenIn found = Round(distance, surface, parts).find();
    const std::size_t before = all.size();
    all.insert(found.begin(), found.end());
    if (all.size() == before) break;
    distance = with_nodes(distance, found);
  }
  return static_cast<Index>(all.size());
}

}  // namespace softreel
