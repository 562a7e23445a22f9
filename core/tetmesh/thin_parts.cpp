#include "core/tetmesh/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/mesh/disjoint_sets.h"
#include "core/tetmesh/isosurface_stuffing.h"

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

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

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
    for (std::int32_t x = low[0]; x <= high[0]; ++x)
      for (std::int32_t y = low[1] + ((low[1] ^ x) & 1); y <= high[1]; y += 2)
        for (std::int32_t z = low[2] + ((low[2] ^ x) & 1); z <= high[2]; z += 2) {
          const double distance = 0.5 * (Vec3(x, y, z) - center).norm();
          if (distance <= reach) visit(LatticeNode{x, y, z}, distance);
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
    if (!torn && steps(triangle, 1.0) > 1)
      visit_samples(triangle, steps(triangle, 1.0),
                    [&](const Vec3& p, int, int) { torn = torn || firm_.near(p, part, parts_) != first; });
    if (torn) fill(triangle, part);
  }

  /// Into how many parts a triangle's sides are to be cut for steps of at most `step` spacings.
  int steps(Index triangle, double step) const {
    const Vec3 &a = corner(triangle, 0), &b = corner(triangle, 1), &c = corner(triangle, 2);
    const double longest = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
    return std::max(1, static_cast<int>(std::ceil(longest / (step * distance_.lattice.frame.spacing))));
  }

  /// Calls visit(point, i, j) at corner 0 + i / n to corner 1 + j / n to corner 2, i + j <= n.
  template <typename Visit>
  void visit_samples(Index triangle, int n, const Visit& visit) const {
    const Vec3 &a = corner(triangle, 0), ab = corner(triangle, 1) - a, ac = corner(triangle, 2) - a;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        visit(Vec3(a + (static_cast<double>(i) / n) * ab + (static_cast<double>(j) / n) * ac), i, j);
  }

  /// Where a triangle is lost or falls apart: samples without a firm node, or beside one of another set, and what lies
  /// within kWindow samples of them. Row i of the grid, place j.
  std::vector<std::vector<bool>> find_tears(Index triangle, Index part, int n) {
    constexpr int kWindow = 4;
    const auto size = static_cast<std::size_t>(n) + 1;
    std::vector<std::vector<Index>> sets(size, std::vector<Index>(size, -1));
    visit_samples(triangle, n, [&](const Vec3& p, int i, int j) { sets[at(i)][at(j)] = firm_.near(p, part, parts_); });
    std::vector<std::vector<bool>> near_tear(size, std::vector<bool>(size, false));
    const auto mark = [&](int i, int j) {
      for (int k = std::max(0, i - kWindow); k <= std::min(n, i + kWindow); ++k)
        for (int l = std::max(0, j - kWindow); l <= std::min(n - k, j + kWindow); ++l) near_tear[at(k)][at(l)] = true;
    };
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Index own = sets[at(i)][at(j)];
        const bool last = i + j == n;
        if (own < 0 || (!last && (sets[at(i + 1)][at(j)] != own || sets[at(i)][at(j + 1)] != own))) mark(i, j);
      }
    return near_tear;
  }

  /// Takes in the nodes under a triangle where it tears: a little below the surface, where a thin part has its middle.
  void fill(Index triangle, Index part) {
    constexpr double kTearStep = 0.5, kStep = 0.12, kDepth = 0.25;
    const Vec3 &a = corner(triangle, 0), area = (corner(triangle, 1) - a).cross(corner(triangle, 2) - a);
    if (!(area.norm() > 0)) return;
    const Vec3 under = -kDepth * distance_.lattice.frame.spacing * area.normalized();
    const int coarse = steps(triangle, kTearStep), fine = steps(triangle, kStep);
    const std::vector<std::vector<bool>> near_tear = find_tears(triangle, part, coarse);
    visit_samples(triangle, fine, [&](const Vec3& p, int i, int j) {
      if (near_tear[at(i * coarse / fine)][at(j * coarse / fine)]) take_in(p + under, triangle, part);
    });
  }

  void take_in(const Vec3& point, Index triangle, Index part) {
    FirmNodes::visit_nodes(distance_.lattice.frame, point, kFillReach, [&](const LatticeNode& node, double) {
      const Index i = distance_.lattice.nodes.find(node);
      const Index nearest = i < 0 ? -1 : distance_.nearest_triangles[at(i)];
      // Not across a gap to another part: parts stay apart where they are.
      if (nearest >= 0 && parts_.triangle_parts[at(nearest)] != part) return;
      taken_in_.emplace(node, triangle);
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
