#include "core/dynamics/recovery.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Eigenvalues>
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

/// Times the stiffness of an element in trouble.
constexpr double kMuchStiffer = 10;

/// About an element in trouble, itself included, that share its rotation at first.
constexpr int kFirstRings = 2;

/// Far above every threshold, and a float still counts shares of a step there.
constexpr float kMostSteps = 65536;

float pace_of(double seconds) {
  return static_cast<float>(std::min(1.0, seconds / kPaceSeconds));
}

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
    rings[e] = kFirstRings + static_cast<int>((trouble.bad_steps - kStepsToTrouble) / kStepsPerRing);
  }
  return rings;
}

/// Spreads to neighbours what is left of the rings less one, until nothing grows; not into what has a mu above
/// `stiffest`, Pa.
void grow(const ElasticBody& body, double stiffest, std::vector<int>& rings) {
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
        if (rings[e] < at_node[static_cast<std::size_t>(node)] && body.laws[e].mu <= stiffest) {
          rings[e] = at_node[static_cast<std::size_t>(node)];
          grows = true;
        }
  }
}

/// The greatest mu, Pa, that may share the rotation of an element in trouble with so many rings; infinite if any may.
/// What is much stiffer is not what gave way, and a rotation that is not its own strains it with all its stiffness; but
/// trouble that lasts may be tangled with it. Whole decades, so that there are few different ones.
double stiffest_beside(const ElasticBody& body, std::size_t e, int rings) {
  const double limit = std::pow(10.0, std::ceil(std::log10(kMuchStiffer * body.laws[e].mu)));
  return rings > kFirstRings ? std::numeric_limits<double>::infinity() : limit;
}

/// Rings of all elements that are to share a rotation for those in trouble: the greatest that any of these asks for.
std::vector<int> find_reach(const ElasticBody& body, const std::vector<int>& seeds) {
  std::map<double, std::vector<int>> groups;
  for (std::size_t e = 0; e < seeds.size(); ++e) {
    if (seeds[e] == 0) continue;
    std::vector<int>& group = groups[stiffest_beside(body, e, seeds[e])];
    group.resize(seeds.size(), 0);
    group[e] = seeds[e];
  }
  std::vector<int> reach(seeds.size(), 0);
  for (auto& [stiffest, group] : groups) {
    grow(body, stiffest, group);
    for (std::size_t e = 0; e < reach.size(); ++e) reach[e] = std::max(reach[e], group[e]);
  }
  return reach;
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

/// Elements that are to share a rotation, connected through nodes.
struct Patch {
  Mat3 sum = Mat3::Zero();   ///< of V F
  double volume = 0;         ///< at rest
  std::int64_t leader = -1;  ///< its first element
};

/// Whether the largest stretch of the mean F is above kDrawnOut: the largest eigenvalue of F^T F above its square.
bool is_drawn_out(const Patch& patch) {
  const Mat3 mean = patch.sum / patch.volume;
  Eigen::SelfAdjointEigenSolver<Mat3> squares;
  squares.computeDirect(mean.transpose() * mean, Eigen::EigenvaluesOnly);
  return squares.eigenvalues()[2] > kDrawnOut * kDrawnOut;
}

}  // namespace

void count_troubles(const ElasticBody& body, std::span<const Vec3> positions, std::int64_t flat, const HeldBody& held,
                    double seconds, ElementTroubles& troubles, RecoveryReport& report) {
  if (flat == 0 && troubles.empty()) return;
  troubles.resize(body.tets.size());
  const float pace = pace_of(seconds);
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
  const std::vector<int> rings = find_reach(body, find_seeds(troubles, may_give_up));
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

void share_rotations(const ElasticBody& body, std::span<const Vec3> positions, double seconds,
                     ElementTroubles& troubles, std::span<const Quaternion> guesses, std::span<Quaternion> rotations,
                     RecoveryReport& report) {
  std::vector<std::size_t> sharing;
  std::vector<Tet> tets;
  for (std::size_t e = 0; e < troubles.size(); ++e)
    if (troubles[e].sharing > 0) {
      sharing.push_back(e);
      tets.push_back(body.tets[e]);
    }
  if (sharing.empty()) return;
  const Pieces patch_of_node = find_pieces(tets, positions.size());
  const auto patch_of = [&](std::size_t e) {
    return static_cast<std::size_t>(patch_of_node.of_node[static_cast<std::size_t>(body.tets[e][0])]);
  };
  // A node of no such element is a piece of its own, without elements.
  std::vector<Patch> patches(static_cast<std::size_t>(patch_of_node.count));
  for (const std::size_t e : sharing) {
    const ElementShape& shape = body.shapes[e];
    Patch& patch = patches[patch_of(e)];
    patch.sum += shape.volume * deformation_gradient(shape.gradients, nodes_of(body.tets[e], positions));
    patch.volume += shape.volume;
    if (patch.leader < 0) patch.leader = static_cast<std::int64_t>(e);
  }
  for (const std::size_t e : sharing) {
    const Patch& patch = patches[patch_of(e)];
    const auto leader = static_cast<std::size_t>(patch.leader);
    if (is_drawn_out(patch)) {
      take(pace_of(seconds), troubles[e].shared_steps);
      troubles[e].sharing = 0;
      continue;
    }
    rotations[e] = e == leader ? find_rotation(patch.sum, guesses[e]) : rotations[leader];
    report.patches += e == leader ? 1 : 0;
    ++report.elements;
  }
}

}  // namespace softreel
