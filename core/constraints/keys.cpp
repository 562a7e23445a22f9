#include "core/constraints/keys.h"

#include <algorithm>
#include <cmath>

namespace softreel {

double eased(Ease ease, double t) {
  switch (ease) {
    case Ease::Constant:
      return 0;
    case Ease::Linear:
      return t;
    case Ease::Smooth:
      return t * t * (3 - 2 * t);
  }
  return t;
}

Transform Transform::operator+(const Transform& o) const {
  return {translate + o.translate, rotate + o.rotate, scale + o.scale, pivot + o.pivot};
}

Transform Transform::operator-(const Transform& o) const {
  return {translate - o.translate, rotate - o.rotate, scale - o.scale, pivot - o.pivot};
}

Transform operator*(double s, const Transform& t) {
  return {s * t.translate, s * t.rotate, s * t.scale, s * t.pivot};
}

Vec3 Transform::apply(const Vec3& p) const {
  if (rotate.isZero(0) && scale == Vec3::Ones()) return p + translate;
  const Vec3 scaled = scale.cwiseProduct(p - pivot);
  const Eigen::AngleAxisd x(rotate.x(), Vec3::UnitX()), y(rotate.y(), Vec3::UnitY()), z(rotate.z(), Vec3::UnitZ());
  return pivot + z * (y * (x * scaled)) + translate;
}

Index active_range(const std::vector<FrameRange>& ranges, double frame) {
  if (ranges.empty()) return 0;
  const auto holds = [&](const FrameRange& range) { return range.first <= frame && frame <= range.last; };
  // Between two frames of which one ends a range and the next begins one, the earlier goes on.
  const auto goes_on = [&](const FrameRange& range) {
    return range.last < frame && range.last == std::floor(range.last) &&
           std::any_of(ranges.begin(), ranges.end(),
                       [&](const FrameRange& next) { return frame < next.first && next.first == range.last + 1; });
  };
  auto found = std::find_if(ranges.begin(), ranges.end(), holds);
  if (found == ranges.end()) found = std::find_if(ranges.begin(), ranges.end(), goes_on);
  return found == ranges.end() ? -1 : static_cast<Index>(found - ranges.begin());
}

bool is_active(const std::vector<FrameRange>& ranges, double frame) {
  return active_range(ranges, frame) >= 0;
}

}  // namespace softreel
