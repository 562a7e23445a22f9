/// Where constraints take points at a frame: by keys or by what they follow, from where the points rest or were
/// grabbed.
#pragma once

#include <span>
#include <vector>

#include "core/constraints/constraints.h"

namespace softreel {

/// What takes the points of one constraint along.
struct Guide {
  const Track<Transform>& track;
  const FollowedMotion* follow = nullptr;  ///< instead of the track
  std::span<const FollowTie> ties;         ///< per point; empty where all space moves as one
};

/// Places of the points at `frame`. Not grabbed: their rest, moved. Grabbed: where they were then, moved from there as
/// their surroundings moved since; exactly there while those do not move. `rest`: per point.
///
/// Where the surroundings had no extent when they were grabbed (a scale of 0, a triangle without area), only their
/// translation since then counts.
std::vector<Vec3> guided_points(const Guide& guide, std::span<const Vec3> rest, double frame, const Grab& grab = {});

/// What a grab becomes when a step has ended at `frame`: dropped if its constraint is off there (range -1) or in
/// another range, taken if it is on and was not. positions(): where its points are now.
template <typename Positions>
void update_grab(Grab& grab, Index range, double frame, const Positions& positions) {
  if (grab.range == range) return;
  grab = {};
  if (range >= 0) grab = {range, frame, positions()};
}

/// The active range of a pull in which it pulls; -1 where it is off or has no strength.
Index pulling_range(const Pull& pull, double frame);

/// How often the force of a pull has come or gone at once until the end of a step at `frame`: where it was switched on
/// or off while it had strength. What has none, or comes from none by its keys, pushes nothing.
Index count_jumps(const Pull& pull, double frame);

}  // namespace softreel
