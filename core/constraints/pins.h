/// Which nodes pins hold at a frame, and where.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "core/constraints/constraints.h"
#include "core/skinning/embedding.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// The nodes that pins hold at one frame.
struct PinnedNodes {
  std::vector<std::uint8_t> held;  ///< per node: 1 if a pin holds it
  std::vector<Vec3> targets;       ///< per node, m; only where held
  Index count = 0;                 ///< of held nodes
  std::string conflict;            ///< names two pins that want one node at different places; empty if there are none
};

/// The pins of a body, by nodes.
class NodePins {
 public:
  /// A pin holds every node of each tetrahedron that carries one of its points, so that the skinned points are exact.
  NodePins(std::vector<Pin> pins, const Embedding& embedding, const TetMesh& mesh);

  /// Nodes that active pins hold at `frame`; a grabbing pin holds what it grabbed, nothing before. Two pins may share a
  /// node where they agree to 1e-9 of the body's size. A node of a pin that follows a surface moves as the surroundings
  /// of the nearest of the pin's points whose tetrahedra it belongs to: points are exact where the surface moves all of
  /// their tetrahedron by one affine map, else to second order of its size.
  PinnedNodes at(double frame, std::span<const Grab> grabs = {}) const;

  /// What grabbing pins hold once a step has ended at `frame` with the nodes at `positions`. grabs: per pin.
  void update(std::span<Grab> grabs, double frame, std::span<const Vec3> positions) const;
  bool grab() const;

  /// The first conflict at a frame where two pins could start to differ (their keys and the ends of their ranges) or at
  /// a whole frame between two such. Empty if there is none; elsewhere, and of pins that grab, `at` still looks.
  std::string find_conflict() const;

 private:
  /// at(), into a workspace whose `held` and `owner` are zero.
  void hold(double frame, std::span<const Grab> grabs, PinnedNodes& pinned, std::vector<std::size_t>& owner) const;
  PinnedNodes nothing_held() const;
  bool share_a_node() const;

  /// The nodes of a pin.
  struct Held {
    std::vector<Index> nodes;     ///< sorted
    std::vector<Vec3> rest;       ///< per node
    std::vector<FollowTie> ties;  ///< per node; empty where its pin has none
  };
  static Held held_by(const Pin& pin, const Embedding& embedding, const TetMesh& mesh);

  std::vector<Pin> pins_;
  std::vector<Held> held_;  ///< per pin
  std::vector<Vec3> rest_positions_;
  double agreement_ = 0;  ///< m
};

}  // namespace softreel
