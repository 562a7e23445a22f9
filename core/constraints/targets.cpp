#include "core/constraints/targets.h"

#include <cmath>
#include <limits>

namespace softreel {
namespace {

/// Surroundings whose volume is below this share of what their axes could span had no extent.
constexpr double kFlatSurroundings = 1e-9;

LocalMotion motion_of(const Transform& transform) {
  LocalMotion motion{Mat3::Identity(), transform.pivot, transform.pivot + transform.translate};
  if (transform.rotate.isZero(0) && transform.scale == Vec3::Ones()) return motion;
  const Transform about_origin{Vec3::Zero(), transform.rotate, transform.scale, Vec3::Zero()};
  for (int k = 0; k < 3; ++k) motion.linear.col(k) = about_origin.apply(Vec3::Unit(k));
  return motion;
}

std::vector<LocalMotion> motions_at(const Guide& guide, double frame) {
  if (guide.follow != nullptr) return guide.follow->motions(guide.ties, frame);
  return {motion_of(guide.track.at(frame))};
}

/// What moved the surroundings from one frame to another.
LocalMotion motion_between(const LocalMotion& then, const LocalMotion& now) {
  LocalMotion between{Mat3::Identity(), then.to, now.to};
  if (then.linear == now.linear && then.from == now.from) return between;
  const Mat3& axes = then.linear;
  const double span = axes.col(0).norm() * axes.col(1).norm() * axes.col(2).norm();
  if (!(std::abs(axes.determinant()) > kFlatSurroundings * span)) return between;
  between.linear = now.linear * axes.inverse();
  between.to += now.linear * (then.from - now.from);
  return between;
}

/// The motion of a point, of one for each or one for all.
const LocalMotion& motion_at(const std::vector<LocalMotion>& motions, std::size_t point) {
  return motions[motions.size() == 1 ? 0 : point];
}

}  // namespace

std::vector<Vec3> guided_points(const Guide& guide, std::span<const Vec3> rest, double frame, const Grab& grab) {
  std::vector<Vec3> places(rest.size());
  if (!grab.holds() && guide.follow == nullptr) {
    const Transform transform = guide.track.at(frame);
    for (std::size_t i = 0; i < rest.size(); ++i) places[i] = transform.apply(rest[i]);
    return places;
  }
  const std::vector<LocalMotion> now = motions_at(guide, frame);
  if (!grab.holds()) {
    for (std::size_t i = 0; i < rest.size(); ++i) places[i] = motion_at(now, i).apply(rest[i]);
    return places;
  }
  const std::vector<LocalMotion> then = motions_at(guide, grab.frame);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const LocalMotion &before = motion_at(then, i), &after = motion_at(now, i);
    places[i] = before == after ? grab.positions[i] : motion_between(before, after).apply(grab.positions[i]);
  }
  return places;
}

Index pulling_range(const Pull& pull, double frame) {
  const Index range = active_range(pull.active, frame);
  return range >= 0 && pull.stiffness.at(frame) > 0 ? range : -1;
}

Index count_jumps(const Pull& pull, double frame) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto jumps_at = [&](double border, double beyond) {
    return !is_active(pull.active, std::nextafter(border, beyond)) && pull.stiffness.at(border) > 0;
  };
  Index count = 0;
  for (const FrameRange& range : pull.active) {
    count += range.first <= frame && jumps_at(range.first, -kInfinity) ? 1 : 0;
    count += range.last < frame && jumps_at(range.last, kInfinity) ? 1 : 0;
  }
  return count;
}

}  // namespace softreel
