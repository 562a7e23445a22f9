#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "assets/generator/distance.h"
#include "assets/generator/features.h"
#include "assets/generator/sculpture.h"

namespace softreel::sculpt {

namespace {

/// The octopus, about 0.9 m tall and 1.1 m wide, facing +z.
class Octopus {
 public:
  Octopus();
  double operator()(const Vec3& p) const;
  double arms(const Vec3& p) const;

 private:
  double mantle(const Vec3& p) const;
  double with_face(double d, const Vec3& p) const;

  std::vector<Limb> arms_;
  std::vector<Station> spots_;
  Eye eye_;
};

/// A point of an arm: `out` m from the axis in direction `angle`, `aside` m to the left of that direction.
Vec3 arm_point(double angle, double out, double height, double aside) {
  const double s = std::sin(angle), c = std::cos(angle);
  return {out * s + aside * c, height, out * c - aside * s};
}

Octopus::Octopus() {
  eye_.center = {0.118, 0.570, 0.180};
  eye_.radius = 0.090;
  eye_.look = Vec3(0.18, 0.05, 1.0).normalized();
  eye_.lid_normal = Vec3(0.20, 1.0, 0.10).normalized();
  eye_.upper = 0.060;
  eye_.lower = 0.074;
  eye_.pupil = 0.042;
  eye_.ramp = 0.013;
  constexpr int kArms = 8;
  for (int i = 0; i < kArms; ++i) {
    const double angle = (i + 0.5) * 2 * std::numbers::pi / kArms;
    const double lift = (i * 5 % 8) * 0.012;  // no two neighbours alike
    arms_.push_back(Limb({{arm_point(angle, 0.08, 0.36, 0), 0.100},
                          {arm_point(angle, 0.19, 0.20, 0), 0.086},
                          {arm_point(angle, 0.31, 0.075, 0.02), 0.074},
                          {arm_point(angle, 0.43, 0.058, 0.07), 0.062},
                          {arm_point(angle, 0.525, 0.090 + 0.5 * lift, 0.14), 0.053},
                          {arm_point(angle, 0.570, 0.165 + lift, 0.175), 0.046},
                          {arm_point(angle, 0.530, 0.240 + lift, 0.160), 0.041},
                          {arm_point(angle, 0.455, 0.245 + lift, 0.125), 0.036}}));
  }
  const Vec3 directions[] = {{0.50, 0.75, 0.45}, {-0.45, 0.85, 0.30}, {0.90, 0.30, 0.20},  {-0.90, 0.35, 0.30},
                             {0.05, 1.0, -0.10}, {0.60, 0.60, -0.5},  {-0.50, 0.60, -0.6}, {-0.95, 0.05, -0.3},
                             {0.0, 0.35, -1.0},  {0.85, 0.0, -0.55},  {0.15, 0.9, 0.45}};
  for (std::size_t i = 0; i < std::size(directions); ++i)
    spots_.push_back({Vec3(0, 0.66, -0.04) + 0.285 * directions[i].normalized(), 0.035 + 0.012 * double(i * 7 % 3)});
}

double Octopus::arms(const Vec3& p) const {
  double d = 1e300;
  for (const Limb& arm : arms_) d = smooth_union(d, arm(p), 0.06);
  return smooth_intersection(d, -p.y(), 0.02);
}

double Octopus::mantle(const Vec3& p) const {
  double d = ellipsoid(p, {0, 0.66, -0.04}, {0.290, 0.285, 0.275}, turned(-8, 0, 0));
  d = smooth_union(d, ellipsoid(p, {0, 0.40, 0.0}, {0.200, 0.160, 0.190}), 0.14);
  for (const Station& s : spots_) {
    // A spot is a low button: the part of a ball that stands out of the mantle by a tenth of its radius.
    const double button = smooth_intersection(sphere(p, s.position, s.radius), d - 0.012, 0.016);
    d = smooth_union(d, button, 0.010);
  }
  return d;
}

double Octopus::with_face(double d, const Vec3& p) const {
  const Vec3 m = mirrored(p);
  d = smooth_union(d, eye_ball(m, eye_), 0.025);
  d += smile_depth(p, {0.50, 0.085, 1.0, 0.05, 0.010, 0.016});
  return smooth_difference(d, sphere(m, {0.078, 0.452, 0.20}, 0.014), 0.02);  // dimples
}

double Octopus::operator()(const Vec3& p) const {
  return smooth_union(with_face(mantle(p), p), arms(p), 0.06);
}

}  // namespace

Sculpture make_octopus() {
  const auto octopus = std::make_shared<Octopus>();
  Sculpture s;
  s.name = "octopus";
  s.distance = [octopus](const Vec3& p) { return (*octopus)(p); };
  s.bounds.add({-0.72, -0.04, -0.72});
  s.bounds.add({0.72, 1.02, 0.72});
  s.cell = 0.0135;
  s.lenses = {{{0, 0.52, 0.24}, 0.36, 0.5}, {{0.125, 0.57, 0.22}, 0.125, 0.45}, {{-0.125, 0.57, 0.22}, 0.125, 0.45}};
  s.parts = {{"soles", [](const Vec3& p) { return p.y() < 0.03; }},
             {"arms", [octopus](const Vec3& p) { return p.y() < 0.33 && octopus->arms(p) < 0.005; }},
             {"tips", [](const Vec3& p) { return p.y() < 0.33 && std::hypot(p.x(), p.z()) > 0.42; }},
             {"mantle", [](const Vec3& p) { return p.y() > 0.6; }},
             {"eyes", [](const Vec3& p) {
                return sphere(mirrored(p), {0.118, 0.570, 0.180}, 0.104) < 0.0;
              }}};
  return s;
}

}  // namespace softreel::sculpt
