/// Pins and pulls of one body, as the simulator takes them.
#pragma once

#include <string>
#include <vector>

#include "core/base/types.h"
#include "core/constraints/followed_motion.h"
#include "core/constraints/keys.h"

namespace softreel {

/// Exact positions: the selected surface points follow track.at(frame).apply(rest point) while active. It holds every
/// node of each tetrahedron that carries one of the points, so that the skinned points are exact too (design 4.4).
struct Pin {
  std::string name;           ///< as messages call it: "body.NAME.pin[2] (shots/a.toml:31)"
  std::vector<Index> points;  ///< surface vertices
  Track<Transform> track;
  std::vector<FrameRange> active;          ///< empty: always
  const FollowedMotion* follow = nullptr;  ///< instead of the track; kept by reference
  std::vector<FollowTie> ties = {};        ///< per point, by follow; empty where all space moves as one
  /// Takes the points where they are when it starts, and moves them on from there as the track (or follow) moves from
  /// then. It starts at the first frame that a step ends at in an active range: the next step is held. Where the next
  /// range begins before a step has ended between them, it is held on into that, and taken anew there.
  bool grab = false;
};

/// Springs from surface points to keyed targets.
struct Pull {
  std::string name;
  std::vector<Index> points;  ///< surface vertices
  /// Per point, the share of the stiffness, sum 1, or less where painted weights are below 1. Resolved by the caller.
  std::vector<double> weights;
  Track<Transform> track;
  Track<double> stiffness;  ///< N/m, of all springs together
  double max_force = 0;     ///< N, of all springs together; 0: no limit
  std::vector<FrameRange> active;
  const FollowedMotion* follow = nullptr;  ///< as of a pin
  std::vector<FollowTie> ties = {};
  bool grab = false;  ///< as of a pin; strength 0 lets go as the end of a range does
};

/// What a constraint grabbed when it started.
struct Grab {
  Index range = -1;             ///< active range that it holds through; -1: it holds nothing
  double frame = 0;             ///< when it started
  std::vector<Vec3> positions;  ///< then, of a pin's nodes or a pull's points, m
  bool holds() const { return range >= 0; }
};

/// Of all pins and pulls, in their order; both empty where none of them grabs.
struct Grabs {
  std::vector<Grab> pins, pulls;
};

}  // namespace softreel
