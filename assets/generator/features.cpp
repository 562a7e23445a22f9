#include "assets/generator/features.h"

#include <algorithm>
#include <cmath>

namespace softreel::sculpt {

double ramp(double x) {
  const double t = std::clamp(x + 0.5, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double eye_ball(const Vec3& p, const Eye& eye) {
  const Vec3 v = p - eye.center;
  const double length = v.norm();
  if (!(length > 0)) return -eye.radius;
  const Vec3 on_ball = eye.radius / length * v;
  const double height = v.dot(eye.lid_normal);
  const double lid = std::max(ramp((height - eye.upper) / eye.ramp), ramp((-height - eye.lower) / eye.ramp));
  const Vec3 side = eye.lid_normal.cross(eye.look).normalized();
  const double off_axis = (on_ball - on_ball.dot(eye.look) * eye.look).norm();
  const double bowl = v.dot(eye.look) > 0 ? ramp((eye.pupil - off_axis) / eye.ramp) : 0;
  const Vec3 spark = eye.radius * eye.look + 0.42 * eye.pupil * (eye.lid_normal - side);
  const double bead = ramp((0.30 * eye.pupil - (on_ball - spark).norm()) / eye.ramp);
  const double relief = 0.10 * lid - 0.22 * (1 - lid) * bowl * (1 - bead);
  return length - eye.radius * (1 + relief);
}

double smile_depth(const Vec3& p, const Smile& smile) {
  if (p.z() < smile.min_z) return 0;
  const double x = p.x(), y = p.y() - smile.center_y;
  const double angle = std::clamp(std::atan2(x, -y), -smile.half_angle, smile.half_angle);
  const double off = std::hypot(x - smile.radius * std::sin(angle), y + smile.radius * std::cos(angle)) / smile.width;
  return smile.depth * std::exp(-off * off);
}

}  // namespace softreel::sculpt
