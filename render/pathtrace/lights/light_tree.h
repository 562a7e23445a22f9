/// Many small emitters in a tree, one of which is chosen by what it may contribute.
///
/// Conty Estevez and Kulla, Importance Sampling of Many Lights with Adaptive Tree Splitting, 2018, with the bounds of
/// Pharr, Jakob and Humphreys, Physically Based Rendering, 4th edition, 2023, sec. 12.6; no splitting.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Directions within `angle` of `axis`.
struct DirectionCone {
  Vec3f axis = Vec3f::Zero();  ///< unit
  float angle = -1;            ///< rad; below 0: no direction at all

  /// A cone that holds both.
  DirectionCone joined(const DirectionCone& other) const;
};

/// Where an emitter is, where it faces, how much it emits.
struct EmitterBounds {
  Vec3f low, high;        ///< corners of its box, m
  DirectionCone normals;  ///< it emits up to a right angle from them
  float power_by_pi = 0;  ///< luminance times area
};

/// What light arrives at.
struct TreeReceiver {
  Vec3f position;
  Vec3f normal;             ///< unit
  bool both_sides = false;  ///< light from behind counts too
};

class LightTree {
 public:
  /// Emitters keep their positions in the list. An empty list is a tree that has nothing to choose.
  explicit LightTree(const std::vector<EmitterBounds>& emitters);

  bool empty() const { return nodes_.empty(); }

  /// Chooses an emitter by `u` in [0, 1), which is replaced by a fresh number in [0, 1). False if none can contribute.
  bool choose(const TreeReceiver& receiver, float& u, Index& emitter, float& probability) const;
  /// Of choosing that emitter; above 0 wherever it can contribute.
  float probability(const TreeReceiver& receiver, Index emitter) const;
  /// Rough irradiance of all emitters; 0 only if there is none.
  float importance(const TreeReceiver& receiver) const;

  /// visit(emitter) of all emitters that a ray of this length may meet, and of some that it only comes near to, in no
  /// order. direction: unit.
  template <typename Visit>
  void visit_along(const Vec3f& origin, const Vec3f& direction, float length, const Visit& visit) const;

 private:
  struct Node {
    Vec3f center;
    float radius2;  ///< of the sphere around the box
    Vec3f axis;
    float cos_spread, sin_spread;  ///< of the cone of normals
    float power;
    Index second;   ///< child; the first one is the next node; 0: a leaf
    Index emitter;  ///< of a leaf
  };
  Index build(std::vector<Index>& order, std::size_t begin, std::size_t end, const std::vector<EmitterBounds>& emitters,
              std::uint64_t trail, int depth);
  static Node node_of(const EmitterBounds& bounds);
  static float importance(const Node& node, const TreeReceiver& receiver);
  static bool may_meet(const Node& node, const Vec3f& origin, const Vec3f& direction, float length);

  static constexpr std::size_t kMostDepth = 32;  ///< halving 2^31 emitters

  std::vector<Node> nodes_;
  std::vector<std::uint64_t> trails_;  ///< per emitter: bit d says which child to take at depth d
};

template <typename Visit>
void LightTree::visit_along(const Vec3f& origin, const Vec3f& direction, float length, const Visit& visit) const {
  if (empty()) return;
  std::array<std::size_t, kMostDepth + 1> waiting{};  // at most one second child a depth
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    std::size_t at = waiting[--count];
    while (may_meet(nodes_[at], origin, direction, length)) {
      if (nodes_[at].second == 0) {
        visit(nodes_[at].emitter);
        break;
      }
      waiting[count++] = static_cast<std::size_t>(nodes_[at].second);
      ++at;
    }
  }
}

}  // namespace softreel
