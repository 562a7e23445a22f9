#include "core/dynamics/recovery.h"

#include <algorithm>

#include <Eigen/LU>

#include "core/elasticity/element_rotation.h"
#include "core/elasticity/winding.h"

namespace softreel {
namespace {

double relative_volume(const ElasticBody& body, std::span<const Vec3> positions, std::size_t e) {
  return deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], positions)).determinant();
}

bool is_held(const HeldBody& held, const Tet& tet) {
  return std::all_of(tet.begin(), tet.end(),
                     [&](Index node) { return held.nodes[static_cast<std::size_t>(node)] != 0; });
}

/// Far above every threshold, and a float still counts shares of a step there.
constexpr float kMostSteps = 65536;

void add(float pace, float& steps) {
  steps = std::min(kMostSteps, steps + pace);
}

void take(float pace, float& steps) {
  steps = std::max(0.0F, steps - pace);
}

/// 1 per element that is inverted or in a ring wound twice; on the way, which elements are watched.
std::vector<std::uint8_t> find_bad(const ElasticBody& body, std::span<const Vec3> positions, const HeldBody& held,
                                   float pace, ElementTroubles& troubles) {
  std::vector<std::uint8_t> bad(troubles.size(), 0);
  std::vector<Index> suspects;
  for (std::size_t e = 0; e < troubles.size(); ++e) {
    const double volume = relative_volume(body, positions, e);
    take(pace, troubles[e].watched);
    if (volume < kFlatVolume) troubles[e].watched = kStepsToWatch;
    if (troubles[e].watched > 0) suspects.push_back(static_cast<Index>(e));
    bad[e] = volume < 0 && !is_held(held, body.tets[e]);
  }
  for (const Index element : find_wound_elements(body, positions, suspects)) {
    const auto e = static_cast<std::size_t>(element);
    troubles[e].watched = kStepsToWatch;
    bad[e] = !is_held(held, body.tets[e]);
  }
  return bad;
}

/// Rings about each element in trouble that are to share its rotation, 1 or more; 0 for the others.
std::vector<int> find_seeds(const ElementTroubles& troubles, const std::vector<std::uint8_t>& may_give_up) {
  std::vector<int> rings(troubles.size(), 0);
  for (std::size_t e = 0; e < rings.size(); ++e) {
    const ElementTrouble& trouble = troubles[e];
    if (trouble.bad_steps < kStepsToTrouble) continue;
    if (may_give_up[e] != 0 && trouble.shared_steps >= kStepsToGiveUp) continue;
    rings[e] = 2 + static_cast<int>((trouble.bad_steps - kStepsToTrouble) / kStepsPerRing);
  }
  return rings;
}

/// Spreads to neighbours what is left of the rings less one, until nothing grows.
void grow(const ElasticBody& body, std::vector<int>& rings) {
  std::vector<int> at_node(body.rest_positions.size(), 0);
  for (bool grows = true; grows;) {
    grows = false;
    for (std::size_t e = 0; e < rings.size(); ++e)
      for (const Index node : body.tets[e]) {
        int& reach = at_node[static_cast<std::size_t>(node)];
        reach = std::max(reach, rings[e] - 1);
      }
    for (std::size_t e = 0; e < rings.size(); ++e)
      for (const Index node : body.tets[e])
        if (rings[e] < at_node[static_cast<std::size_t>(node)]) {
          rings[e] = at_node[static_cast<std::size_t>(node)];
          grows = true;
        }
  }
}

/// 1 per element that a pin or pull holds through its piece, so that its trouble may be theirs.
std::vector<std::uint8_t> find_held_pieces(const ElasticBody& body, const HeldBody& held) {
  std::vector<std::uint8_t> of_element(body.tets.size());
  for (std::size_t e = 0; e < of_element.size(); ++e) {
    const auto node = static_cast<std::size_t>(body.tets[e][0]);
    of_element[e] = held.pieces[static_cast<std::size_t>(held.all_pieces.of_node[node])];
  }
  return of_element;
}

}  // namespace

void count_troubles(const ElasticBody& body, std::span<const Vec3> positions, std::int64_t flat, const HeldBody& held,
                    double seconds, ElementTroubles& troubles, RecoveryReport& report) {
  if (flat == 0 && troubles.empty()) return;
  troubles.resize(body.tets.size());
  const auto pace = static_cast<float>(std::min(1.0, seconds / kPaceSeconds));
  const std::vector<std::uint8_t> bad = find_bad(body, positions, held, pace, troubles),
                                  may_give_up = find_held_pieces(body, held);
  for (std::size_t e = 0; e < bad.size(); ++e) {
    ElementTrouble& trouble = troubles[e];
    take(pace, trouble.sharing);
    if (bad[e] != 0)
      add(pace, trouble.bad_steps);
    else
      trouble.bad_steps = 0;
    if (bad[e] == 0 && trouble.sharing == 0) take(pace, trouble.shared_steps);
  }
  std::vector<int> rings = find_seeds(troubles, may_give_up);
  grow(body, rings);
  for (std::size_t e = 0; e < bad.size(); ++e) {
    ElementTrouble& trouble = troubles[e];
    if (rings[e] > 0) trouble.sharing = kStepsToShare;
    if (trouble.sharing == 0) continue;
    const bool had_hope = trouble.shared_steps < kStepsToGiveUp;
    add(pace, trouble.shared_steps);
    const bool hopeless = had_hope && trouble.shared_steps >= kStepsToGiveUp;
    if (bad[e] != 0 && may_give_up[e] != 0 && hopeless) ++report.given_up;
  }
  if (std::all_of(troubles.begin(), troubles.end(), [](const ElementTrouble& t) { return t == ElementTrouble{}; }))
    troubles = {};
}

void share_rotations(const ElasticBody& body, std::span<const Vec3> positions, const ElementTroubles& troubles,
                     std::span<const Quaternion> guesses, std::span<Quaternion> rotations, RecoveryReport& report) {
  std::vector<std::size_t> sharing;
  std::vector<Tet> tets;
  for (std::size_t e = 0; e < troubles.size(); ++e)
    if (troubles[e].sharing > 0) {
      sharing.push_back(e);
      tets.push_back(body.tets[e]);
    }
  if (sharing.empty()) return;
  const Pieces patches = find_pieces(tets, positions.size());
  const auto patch_of = [&](std::size_t e) {
    return static_cast<std::size_t>(patches.of_node[static_cast<std::size_t>(body.tets[e][0])]);
  };
  // A node of no such element is a piece of its own, without elements.
  std::vector<Mat3> sums(static_cast<std::size_t>(patches.count), Mat3::Zero());
  std::vector<std::int64_t> first(sums.size(), -1);
  for (const std::size_t e : sharing) {
    const ElementShape& shape = body.shapes[e];
    sums[patch_of(e)] += shape.volume * deformation_gradient(shape.gradients, nodes_of(body.tets[e], positions));
    if (first[patch_of(e)] < 0) first[patch_of(e)] = static_cast<std::int64_t>(e);
  }
  for (const std::size_t e : sharing) {
    const auto leader = static_cast<std::size_t>(first[patch_of(e)]);
    rotations[e] = e == leader ? find_rotation(sums[patch_of(e)], guesses[e]) : rotations[leader];
    report.patches += e == leader ? 1 : 0;
  }
  report.elements = static_cast<Index>(sharing.size());
}

}  // namespace softreel
