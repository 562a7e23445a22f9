#include "assets/generator/distance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softreel::sculpt {

double sphere(const Vec3& p, const Vec3& center, double radius) {
  return (p - center).norm() - radius;
}

double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 q = p - center;
  const double k0 = q.cwiseQuotient(radii).norm();
  const double k1 = q.cwiseQuotient(radii.cwiseProduct(radii)).norm();
  if (!(k1 > 0)) return -radii.minCoeff();  // the centre itself
  return k0 * (k0 - 1) / k1;
}

double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii, const Mat3& axes) {
  return ellipsoid(axes.transpose() * (p - center), Vec3::Zero(), radii);
}

double rounded_box(const Vec3& p, const Vec3& half, double radius) {
  const Vec3 q = p.cwiseAbs() - half + Vec3::Constant(radius);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - radius;
}

double round_cone(const Vec3& p, const Station& a, const Station& b) {
  const Vec3 axis = b.position - a.position, q = p - a.position;
  const double l2 = axis.squaredNorm(), rr = a.radius - b.radius, a2 = l2 - rr * rr;
  if (!(a2 > 0)) return std::min(q.norm() - a.radius, (p - b.position).norm() - b.radius);  // one holds the other
  const double il2 = 1 / l2, y = q.dot(axis), z = y - l2;
  const double x2 = (q * l2 - axis * y).squaredNorm(), y2 = y * y * l2, z2 = z * z * l2;
  const double k = (rr < 0 ? -1.0 : 1.0) * rr * rr * x2;
  if ((z < 0 ? -1.0 : 1.0) * a2 * z2 > k) return std::sqrt(x2 + z2) * il2 - b.radius;
  if ((y < 0 ? -1.0 : 1.0) * a2 * y2 < k) return std::sqrt(x2 + y2) * il2 - a.radius;
  return (std::sqrt(x2 * a2 * il2) + y * rr) * il2 - a.radius;
}

namespace {

template <typename T>
T catmull_rom(const T& before, const T& a, const T& b, const T& after, double t) {
  const double t2 = t * t, t3 = t2 * t;
  return 0.5 *
         (2 * a + t * (b - before) + t2 * (2 * before - 5 * a + 4 * b - after) + t3 * (3 * a - before - 3 * b + after));
}

}  // namespace

Limb::Limb(const std::vector<Station>& stations) {
  constexpr int kPieces = 8;  // per span: the kinks between pieces are then far below a lattice cell
  const int last = static_cast<int>(stations.size()) - 1;
  const auto at = [&](int i) -> const Station& { return stations[static_cast<std::size_t>(std::clamp(i, 0, last))]; };
  for (int i = 0; i < last; ++i)
    for (int piece = 0; piece < kPieces; ++piece) {
      const double t = double(piece) / kPieces;
      samples_.push_back({catmull_rom(at(i - 1).position, at(i).position, at(i + 1).position, at(i + 2).position, t),
                          catmull_rom(at(i - 1).radius, at(i).radius, at(i + 1).radius, at(i + 2).radius, t)});
    }
  samples_.push_back(stations.back());
  for (const Station& s : samples_) center_ += s.position / static_cast<double>(samples_.size());
  for (const Station& s : samples_) reach_ = std::max(reach_, (s.position - center_).norm() + s.radius);
}

double Limb::operator()(const Vec3& p) const {
  constexpr double kFar = 0.25;  // m, wider than any blend: the bound below never shapes a surface
  const double bound = (p - center_).norm() - reach_;
  if (bound > kFar) return bound;
  double distance = 1e300;
  for (std::size_t i = 0; i + 1 < samples_.size(); ++i)
    distance = std::min(distance, round_cone(p, samples_[i], samples_[i + 1]));
  return distance;
}

double smooth_union(double a, double b, double blend) {
  if (!(blend > 0)) return std::min(a, b);
  const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
  return std::min(a, b) - h * h * h * blend / 6;
}

double smooth_difference(double a, double b, double blend) {
  return -smooth_union(-a, b, blend);
}

double smooth_intersection(double a, double b, double blend) {
  return -smooth_union(-a, -b, blend);
}

Vec3 mirrored(const Vec3& p) {
  return {std::abs(p.x()), p.y(), p.z()};
}

std::vector<Station> reflected(std::vector<Station> stations) {
  for (Station& s : stations) s.position.x() = -s.position.x();
  return stations;
}

Mat3 turned(double x_deg, double y_deg, double z_deg) {
  constexpr double kRadian = std::numbers::pi / 180;
  return (Eigen::AngleAxisd(z_deg * kRadian, Vec3::UnitZ()) * Eigen::AngleAxisd(y_deg * kRadian, Vec3::UnitY()) *
          Eigen::AngleAxisd(x_deg * kRadian, Vec3::UnitX()))
      .toRotationMatrix();
}

}  // namespace softreel::sculpt
