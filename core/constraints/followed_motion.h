/// What pins and pulls may follow instead of keys: an animated node, or an animated surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// How the surroundings of a point move: p -> to + linear (p - from).
struct LocalMotion {
  Mat3 linear = Mat3::Identity();
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();

  Vec3 apply(const Vec3& p) const { return to + linear * (p - from); }
  bool operator==(const LocalMotion&) const = default;
};

/// Where a point hangs on a followed surface: weights of a triangle's corners, sum 1.
struct FollowTie {
  Triangle vertices{0, 0, 0};
  Vec3 weights = Vec3(1, 0, 0);
};

/// A motion in the scene, m, over the frames of the shot. All members are thread-safe.
class FollowedMotion {
 public:
  virtual ~FollowedMotion() = default;

  /// Ties of points at rest, given by place and number among the vertices of the body's surface; none where all space
  /// moves as one.
  virtual std::vector<FollowTie> tie(std::span<const Vec3> points, std::span<const Index> vertices) const = 0;
  /// Of points that each hang on what is nearest to it: how far the farthest is from there, m. 0 for others.
  virtual double farthest_from(std::span<const Vec3> points, std::span<const FollowTie> ties) const;
  /// The motion from rest to `frame` at each tie; one for all where there are no ties.
  virtual std::vector<LocalMotion> motions(std::span<const FollowTie> ties, double frame) const = 0;
  /// Numbers that are equal at two frames only if the motion is: what keys of results hash.
  virtual std::vector<double> pose(double frame) const = 0;
  /// Of all that shapes the motion beside the pose.
  virtual std::uint64_t content() const = 0;
};

inline double FollowedMotion::farthest_from(std::span<const Vec3>, std::span<const FollowTie>) const {
  return 0;
}

/// Seconds of a clip at a frame of the shot; before its start they are below 0.
struct ClipTiming {
  double start_frame = 1;  ///< where the clip's time 0 is
  double fps = 24;
  double speed = 1;  ///< seconds of the clip a second of the shot

  double seconds(double frame) const { return (frame - start_frame) / fps * speed; }
};

}  // namespace softreel
