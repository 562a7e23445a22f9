#include "core/tetmesh/graded/gap_refinement.h"

#include <algorithm>
#include <cmath>

namespace softreel {
namespace {

/// Tetrahedra of a leaf inside, and about so many more of one that the surface cuts.
constexpr double kTetsPerLeaf = 12.0, kTetsPerCut = 1.6;

/// What is cut where leaves of different sizes meet, and what neighbours are halved for it later, comes on top.
constexpr double kTransitions = 1.4;

/// A place whose leaf is to be of this level.
struct Wish {
  Vec3 point;
  std::int32_t level;
};

/// The largest leaves at a gap, at the two ends of it and near the corners of its face, halved so many times.
void wish_at(const GradedOctree& octree, const BoundaryGap& gap, const std::vector<Vec3>& nodes, std::int32_t halvings,
             std::vector<Wish>& wishes) {
  std::array<Vec3, 5> points{gap.on_surface, gap.on_boundary};
  std::size_t count = 2;
  if (gap.face[0] >= 0)
    for (std::size_t k = 0; k < 3; ++k)
      points[count++] =
          0.8 * nodes[at(gap.face[k])] + 0.1 * (nodes[at(gap.face[(k + 1) % 3])] + nodes[at(gap.face[(k + 2) % 3])]);
  std::array<std::int32_t, 5> levels{};
  for (std::size_t k = 0; k < count; ++k) levels[k] = octree.level_at(points[k]);
  const std::int32_t most = *std::max_element(levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t k = 0; k < count; ++k)
    if (most > 0 && levels[k] == most) wishes.push_back({points[k], std::max(0, most - halvings)});
}

/// Tetrahedra that come of halving a leaf: the share of it that is inside becomes eight times as many, and where the
/// surface passes there are four cut leaves instead of one.
double added_by(const OctreeCell& first_child, const GradedOctree& octree, const SurfaceDistance& known) {
  const OctreeCell parent{first_child.low, first_child.level + 1};
  const Index node = known.lattice.nodes.find(parent.center());
  const double width = 0.5 * octree.frame().spacing * parent.width();
  const double value = node < 0 ? 0.0 : known.lattice.values[at(node)];  // unknown of leaves that came just now
  const double share = std::clamp(0.5 - value / width, 0.0, 1.0);
  return kTransitions * (7 * kTetsPerLeaf * share + (share > 0 && share < 1 ? 3 * kTetsPerCut : 0.0));
}

}  // namespace

double width_of(const BoundaryGap& gap) {
  return (gap.on_surface - gap.on_boundary).norm();
}

double widest(const std::vector<BoundaryGap>& gaps) {
  double width = 0;
  for (const BoundaryGap& gap : gaps) width = std::max(width, width_of(gap));
  return width;
}

double widest_reachable(const GradedOctree& octree, const std::vector<BoundaryGap>& gaps,
                        const std::vector<Vec3>& nodes) {
  double width = 0;
  std::vector<Wish> wishes;
  for (const BoundaryGap& gap : gaps) {
    if (!(width_of(gap) > width)) continue;
    wishes.clear();
    wish_at(octree, gap, nodes, 1, wishes);
    if (!wishes.empty()) width = width_of(gap);
  }
  return width;
}

bool refine_gaps(GradedOctree& octree, const std::vector<BoundaryGap>& gaps, const std::vector<Vec3>& nodes,
                 double margin) {
  std::vector<Wish> wishes;
  for (const BoundaryGap& gap : gaps) wish_at(octree, gap, nodes, 1, wishes);
  const std::size_t before = octree.cells().size();
  for (const Wish& wish : wishes) octree.refine(wish.point, wish.level, margin);
  return octree.cells().size() > before;
}

WidestRefined refine_widest(GradedOctree& octree, const std::vector<BoundaryGap>& gaps, const std::vector<Vec3>& nodes,
                            const SurfaceDistance& known, const WidestWanted& wanted) {
  const GradedOctree before = octree;  // what leaves there were: none is halved twice
  std::vector<Wish> wishes;
  WidestRefined done;
  for (const BoundaryGap& gap : gaps) {
    if (done.added_tets >= wanted.most_added) break;
    const std::size_t first = octree.cells().size();
    wishes.clear();
    wish_at(before, gap, nodes, width_of(gap) > wanted.twice_from ? 2 : 1, wishes);
    for (const Wish& wish : wishes) octree.refine(wish.point, wish.level, 0.0);
    for (std::size_t child = first; child < octree.cells().size(); child += 8) {
      done.added_tets += added_by(octree.cells()[child], octree, known);
      ++done.halved;
    }
    if (octree.cells().size() > first) done.narrowest = width_of(gap);
  }
  return done;
}

}  // namespace softreel
