#include "core/tetmesh/filling/touching_solids.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "core/mesh/box_tree.h"
#include "core/tetmesh/filling/crossing_surfaces.h"

namespace softreel {
namespace {

/// What is nearer than this share of the larger diagonal touches.
constexpr double kTouchReach = 1e-5;

Bounds box_of(const Solid& solid) {
  Bounds box;
  for (const SurfacePart& part : solid.parts.parts) {
    box.add(part.box.min);
    box.add(part.box.max);
  }
  return box;
}

}  // namespace

std::vector<std::array<Index, 2>> find_touching(const std::vector<Solid>& solids) {
  std::vector<Bounds> boxes;
  for (const Solid& solid : solids) boxes.push_back(box_of(solid));
  std::vector<std::unique_ptr<TriangleClusters>> trees(solids.size());
  const auto tree = [&](Index s) -> const TriangleClusters& {
    const SurfaceMesh& surface = solids[at(s)].surface;
    if (!trees[at(s)]) trees[at(s)] = std::make_unique<TriangleClusters>(surface.positions, surface.triangles);
    return *trees[at(s)];
  };
  const auto touch = [&](Index s, Index t) {
    if (solids[at(s)].has_open_parts() || solids[at(t)].has_open_parts()) return false;
    const double reach = kTouchReach * std::max(boxes[at(s)].diagonal(), boxes[at(t)].diagonal());
    return BoxTree::is_near(boxes[at(s)], boxes[at(t)], reach) &&
           (any_cross(tree(s), tree(t), reach * kAskew) || any_cross(tree(s), tree(t), -reach * kAskew));
  };
  const BoxTree near(boxes);
  std::vector<std::array<Index, 2>> found;
  for (Index s = 0; s < static_cast<Index>(solids.size()); ++s)
    near.visit_near(boxes[at(s)], kTouchReach * boxes[at(s)].diagonal(), [&](Index t) {
      if (t == s) return;
      const std::array<Index, 2> pair{std::min(s, t), std::max(s, t)};
      // Where both see each other, the first asks.
      const bool is_mutual = BoxTree::is_near(boxes[at(s)], boxes[at(t)], kTouchReach * boxes[at(t)].diagonal());
      if ((s < t || !is_mutual) && touch(pair[0], pair[1])) found.push_back(pair);
    });
  std::sort(found.begin(), found.end());
  return found;
}

void warn_of_touching(const std::vector<Solid>& solids, const std::string& name, const Log& log) {
  const std::vector<std::array<Index, 2>> touching = find_touching(solids);
  if (touching.empty()) return;
  const auto place = [&](std::size_t k) { return solids[at(touching.front()[k])].parts.parts.front().place(); };
  const std::size_t more = touching.size() - 1;
  log.warn(fmt::format(
      "body '{}': {} and {} touch{}, and do not overlap: each is filled for itself, and nothing holds them together. "
      "Accepted: these, as they are. Let parts overlap a little that should be one.",
      name, place(0), place(1),
      more == 0   ? ""
      : more == 1 ? ", as one more pair of parts does"
                  : fmt::format(", as {} more pairs of parts do", more)));
}

}  // namespace softreel
