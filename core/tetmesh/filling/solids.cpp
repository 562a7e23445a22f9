#include "core/tetmesh/filling/solids.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/mesh/box_tree.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/winding_number.h"
#include "core/tetmesh/filling/crossing_surfaces.h"

namespace softreel {
namespace {

/// Open parts nearer than this share of the larger diagonal may close each other.
constexpr double kOpenReach = 0.02;

/// Points of a part that are looked at to tell whether it lies inside another.
constexpr std::size_t kSamples = 5;

std::vector<Bounds> boxes_of(const std::vector<SurfacePart>& parts) {
  std::vector<Bounds> boxes;
  for (const SurfacePart& part : parts) boxes.push_back(part.box);
  return boxes;
}

/// The parts with what is asked of them made when it is first asked.
class Joining {
 public:
  Joining(const SurfaceMesh& surface, const SurfaceParts& parts)
      : surface_(surface),
        parts_(parts),
        boxes_(boxes_of(parts.parts)),
        triangles_(parts.parts.size()),
        trees_(parts.parts.size()),
        windings_(parts.parts.size()),
        sets_(parts.parts.size()) {
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      if (const Index part = parts.triangle_parts[t]; part >= 0) triangles_[at(part)].push_back(surface.triangles[t]);
  }

  std::vector<Index> run() {
    join_near_and_crossing();
    for (Index p = 0; p < count(); ++p)
      if (const Index around = innermost_around(p); around >= 0) sets_.join(p, around);
    std::vector<Index> number(parts_.parts.size(), -1), solids;
    Index numbered = 0;
    for (Index p = 0; p < count(); ++p) {
      Index& solid = number[at(sets_.root(p))];
      if (solid < 0) solid = numbered++;
      solids.push_back(solid);
    }
    return solids;
  }

 private:
  Index count() const { return static_cast<Index>(parts_.parts.size()); }
  const Bounds& box(Index p) const { return parts_.parts[at(p)].box; }
  bool is_open(Index p) const { return parts_.parts[at(p)].open; }

  void join_near_and_crossing() {
    const bool any_open =
        std::any_of(parts_.parts.begin(), parts_.parts.end(), [](const SurfacePart& part) { return part.open; });
    // Those that may join are found from the larger one: a great hall does not make every pebble ask far.
    for (Index p = 0; p < count(); ++p)
      boxes_.visit_near(box(p), any_open ? kOpenReach * box(p).diagonal() : 0, [&](Index q) {
        if (q == p || (q < p && !is_open(p) && !is_open(q)) || sets_.root(p) == sets_.root(q)) return;
        if (are_joined(std::min(p, q), std::max(p, q))) sets_.join(p, q);
      });
  }

  bool are_joined(Index p, Index q) {
    const double reach = kOpenReach * std::max(box(p).diagonal(), box(q).diagonal());
    if (is_open(p) || is_open(q)) return BoxTree::is_near(box(p), box(q), reach);
    const Vec3 shift = 1e-7 * std::max(box(p).diagonal(), box(q).diagonal()) * kAskew;
    return BoxTree::is_near(box(p), box(q), 0) && any_cross(tree(p), tree(q), shift) &&
           any_cross(tree(p), tree(q), -shift);
  }

  /// Of the parts around a closed one the smallest, if that one lies in their material; -1 if it lies outside.
  Index innermost_around(Index p) {
    if (is_open(p)) return -1;
    double winding = 0;
    Index innermost = -1;
    boxes_.visit_near(box(p), 0, [&](Index q) {
      if (q == p || !BoxTree::contains(box(q), box(p))) return;
      const double turns = turns_around(p, q);
      if (std::abs(turns) < 0.5) return;
      winding += turns;
      if (innermost < 0 || std::abs(parts_.parts[at(q)].volume) < std::abs(parts_.parts[at(innermost)].volume))
        innermost = q;
    });
    return std::abs(winding) > 0.5 ? innermost : -1;
  }

  /// How often part q goes round part p: the middle one of some points of p.
  double turns_around(Index p, Index q) {
    const std::vector<Triangle>& triangles = triangles_[at(p)];
    std::vector<double> turns;
    for (std::size_t k = 0; k < kSamples; ++k) {
      const Triangle& t = triangles[k * triangles.size() / kSamples];
      const Vec3 middle =
          (surface_.positions[at(t[0])] + surface_.positions[at(t[1])] + surface_.positions[at(t[2])]) / 3;
      turns.push_back(winding(q)(middle));
    }
    std::nth_element(turns.begin(), turns.begin() + kSamples / 2, turns.end());
    return std::round(turns[kSamples / 2]);
  }

  const TriangleClusters& tree(Index p) {
    if (!trees_[at(p)]) trees_[at(p)] = std::make_unique<TriangleClusters>(surface_.positions, triangles_[at(p)]);
    return *trees_[at(p)];
  }
  const WindingNumber& winding(Index p) {
    if (!windings_[at(p)]) windings_[at(p)] = std::make_unique<WindingNumber>(surface_.positions, triangles_[at(p)]);
    return *windings_[at(p)];
  }

  const SurfaceMesh& surface_;
  const SurfaceParts& parts_;
  BoxTree boxes_;
  std::vector<std::vector<Triangle>> triangles_;  ///< per part
  std::vector<std::unique_ptr<TriangleClusters>> trees_;
  std::vector<std::unique_ptr<WindingNumber>> windings_;
  DisjointSets sets_;
};

}  // namespace

bool Solid::has_open_parts() const {
  return std::any_of(parts.parts.begin(), parts.parts.end(), [](const SurfacePart& part) { return part.open; });
}

const SurfacePart& Solid::thinnest_part() const {
  const auto thickness = [](const SurfacePart& part) {
    return part.is_flat() ? 1e300 : std::abs(part.volume) / part.area;
  };
  return *std::min_element(parts.parts.begin(), parts.parts.end(),
                           [&](const SurfacePart& a, const SurfacePart& b) { return thickness(a) < thickness(b); });
}

std::vector<Index> find_solids(const SurfaceMesh& surface, const SurfaceParts& parts) {
  if (parts.parts.size() <= 1) return std::vector<Index>(parts.parts.size(), 0);
  return Joining(surface, parts).run();
}

std::vector<Index> find_triangle_solids(const SurfaceMesh& surface) {
  SurfaceParts shells = find_shells(surface);
  if (shells.parts.size() <= 1 ||
      std::any_of(shells.parts.begin(), shells.parts.end(), [](const SurfacePart& shell) { return shell.open; }))
    return std::move(shells.triangle_parts);
  const std::vector<Index> solids = find_solids(surface, shells);
  for (Index& shell : shells.triangle_parts)
    if (shell >= 0) shell = solids[at(shell)];
  return std::move(shells.triangle_parts);
}

Index count_solids(const SurfaceMesh& surface) {
  const std::vector<Index> solids = find_triangle_solids(surface);
  return solids.empty() ? 0 : *std::max_element(solids.begin(), solids.end()) + 1;
}

std::vector<Solid> split_solids(const SurfaceMesh& surface, const SurfaceParts& parts,
                                const std::vector<Index>& solids) {
  const Index count = solids.empty() ? 0 : *std::max_element(solids.begin(), solids.end()) + 1;
  std::vector<Solid> split(at(count));
  std::vector<Index> part_numbers;  // in its solid
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    std::vector<SurfacePart>& own = split[at(solids[p])].parts.parts;
    part_numbers.push_back(static_cast<Index>(own.size()));
    own.push_back(parts.parts[p]);
  }
  std::vector<Index> vertex_numbers(surface.positions.size(), -1);  // parts share no vertices
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto part = at(parts.triangle_parts[t]);
    Solid& solid = split[at(solids[part])];
    Triangle triangle = surface.triangles[t];
    for (Index& v : triangle) {
      Index& number = vertex_numbers[at(v)];
      if (number < 0) {
        number = static_cast<Index>(solid.surface.positions.size());
        solid.surface.positions.push_back(surface.positions[at(v)]);
      }
      v = number;
    }
    solid.surface.triangles.push_back(triangle);
    solid.parts.triangle_parts.push_back(part_numbers[part]);
  }
  for (Solid& solid : split) {  // they live as long as the filling
    solid.surface.positions.shrink_to_fit();
    solid.surface.triangles.shrink_to_fit();
    solid.parts.triangle_parts.shrink_to_fit();
  }
  return split;
}

}  // namespace softreel
