#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "assets/generator/distance.h"
#include "assets/generator/features.h"
#include "assets/generator/sculpture.h"

namespace softreel::sculpt {

namespace {

/// The baby dragon, about 1 m tall, feet on y = 0, facing +z. Nothing that sticks out is thinner than 0.07 m.
class Creature {
 public:
  double operator()(const Vec3& p) const;
  /// Paint: sRGB code values.
  Vec3 color(const Vec3& p) const;

  double head(const Vec3& p) const;
  double arms(const Vec3& p) const { return std::min(left_arm(p), right_arm(p)); }
  /// In the scene; side: 1 for the left eye, -1 for the right one.
  static Vec3 eye_center(int side) {
    const Vec3 q(side * kEye.x(), kEye.y(), kEye.z());
    return kHeadScale * (kHeadTurn * (q - kNeck)) + kNeck;
  }
  static double eye(const Vec3& p) { return sphere(mirrored(to_head(p)), kEye, kEyeRadius); }
  static Vec3 to_head(const Vec3& p) { return kHeadTurn.transpose() * (p - kNeck) / kHeadScale + kNeck; }

 private:
  static inline const Mat3 kHeadTurn = turned(0, -6, 6);
  static inline const Vec3 kNeck{0, 0.60, 0.02}, kEye{0.098, 0.797, 0.136};
  static constexpr double kEyeRadius = 0.074, kHeadScale = 1.15;

  double feet(const Vec3& p) const;
  double trunk(const Vec3& p) const;
  double left_arm(const Vec3& p) const;
  double right_arm(const Vec3& p) const;
  double tail_leaf(const Vec3& p) const;
  double crest(const Vec3& p) const;
  double skull(const Vec3& q) const;
  double ear(const Vec3& q) const;
  double with_face(double d, const Vec3& q) const;
  double with_eyes(double d, const Vec3& q) const;
  static Eye eye_shape();
  static Vec3 eye_color(const Vec3& q);
  static double horns(const Vec3& q);

  Limb leg_{{{{0.150, 0.06, 0.01}, 0.085}, {{0.150, 0.15, 0.0}, 0.090}, {{0.12, 0.27, -0.01}, 0.125}}};
  Limb neck_{{{{0, 0.46, -0.01}, 0.115}, {{0, 0.55, 0.0}, 0.09}, {{0, 0.66, 0.02}, 0.1}}};
  Limb left_arm_{{{{0.11, 0.505, 0.0}, 0.068}, {{0.215, 0.465, 0.01}, 0.058}, {{0.305, 0.395, 0.055}, 0.052}}};
  Limb right_arm_{{{{-0.11, 0.505, 0.0}, 0.068}, {{-0.235, 0.465, 0.02}, 0.058}, {{-0.345, 0.535, 0.075}, 0.052}}};
  Limb tail_{{{{0, 0.28, -0.08}, 0.135},
              {{-0.02, 0.17, -0.23}, 0.100},
              {{-0.11, 0.13, -0.36}, 0.074},
              {{-0.25, 0.165, -0.42}, 0.056},
              {{-0.35, 0.27, -0.39}, 0.042},
              {{-0.36, 0.36, -0.36}, 0.036}}};
  std::vector<std::pair<Vec3, Vec3>> spikes_{{{0, 0.505, -0.090}, {0, 0.535, -0.165}},
                                             {{0, 0.405, -0.145}, {0, 0.435, -0.230}},
                                             {{0, 0.300, -0.190}, {0, 0.345, -0.275}},
                                             {{-0.02, 0.225, -0.265}, {-0.03, 0.300, -0.325}},
                                             {{-0.085, 0.175, -0.350}, {-0.095, 0.250, -0.405}}};
};

double Creature::feet(const Vec3& p) const {
  const Vec3 q = mirrored(p);
  double d = ellipsoid(q, {0.155, 0.05, 0.05}, {0.095, 0.075, 0.125}, turned(0, 12, 0));
  for (int toe = -1; toe <= 1; ++toe) {
    const Vec3 center(0.178 + 0.062 * toe, 0.04, 0.155 - 0.018 * std::abs(toe) - 0.010 * toe);
    d = smooth_union(d, ellipsoid(q, center, {0.038, 0.045, 0.055}), 0.02);
  }
  d = smooth_union(d, leg_(q), 0.05);
  return smooth_intersection(d, -p.y(), 0.02);  // flat soles
}

double Creature::trunk(const Vec3& p) const {
  double d = ellipsoid(p, {0, 0.33, -0.01}, {0.195, 0.185, 0.17});
  d = smooth_union(d, ellipsoid(p, {0, 0.47, 0.0}, {0.145, 0.13, 0.12}), 0.12);
  d = smooth_union(d, ellipsoid(p, {0, 0.315, 0.075}, {0.165, 0.160, 0.135}), 0.04);
  // Narrow grooves part the belly into plates; they fade out towards its sides.
  const double side = p.x() / 0.13, front = (p.z() - 0.09) / 0.04, low = (0.46 - p.y()) / 0.04;
  const double mask = std::max(0.0, 1 - side * side) * std::clamp(front, 0.0, 1.0) * std::clamp(low, 0.0, 1.0);
  const double row = (p.y() - 0.7 * p.x() * p.x()) / 0.058;
  const double off = 0.058 * (row - std::round(row)) / 0.011;
  return d + 0.006 * std::min(1.0, 2 * mask) * std::exp(-off * off);
}

double Creature::left_arm(const Vec3& p) const {
  double d = smooth_union(left_arm_(p), ellipsoid(p, {0.330, 0.350, 0.08}, {0.055, 0.062, 0.055}), 0.03);
  const Vec3 finger[] = {{0.300, 0.308, 0.120}, {0.345, 0.292, 0.105}, {0.380, 0.318, 0.080}};
  for (const Vec3& tip : finger) d = smooth_union(d, sphere(p, tip, 0.034), 0.022);
  return d;
}

double Creature::right_arm(const Vec3& p) const {
  double d = smooth_union(right_arm_(p), ellipsoid(p, {-0.375, 0.585, 0.09}, {0.058, 0.06, 0.05}), 0.03);
  const Vec3 finger[] = {{-0.335, 0.632, 0.112}, {-0.388, 0.650, 0.102}, {-0.432, 0.618, 0.092}};
  for (const Vec3& tip : finger) d = smooth_union(d, sphere(p, tip, 0.034), 0.022);
  return d;
}

double Creature::tail_leaf(const Vec3& p) const {
  const Vec3 q = turned(-15, 10, 5).transpose() * (p - Vec3(-0.355, 0.415, -0.335));
  double d = ellipsoid(mirrored(q), {0.034, -0.012, 0}, {0.062, 0.062, 0.042}, turned(0, 0, -35));
  return smooth_union(d, round_cone(q, {{0, 0.0, 0}, 0.045}, {{0, 0.085, 0}, 0.024}), 0.05);
}

double Creature::crest(const Vec3& p) const {
  double d = 1e300;
  for (const auto& [root, tip] : spikes_) d = std::min(d, round_cone(p, {root, 0.050}, {tip, 0.024}));
  return d;
}

double Creature::skull(const Vec3& q) const {
  double d = ellipsoid(q, {0, 0.775, 0.02}, {0.195, 0.165, 0.17});
  d = smooth_union(d, ellipsoid(mirrored(q), {0.115, 0.695, 0.09}, {0.085, 0.075, 0.085}), 0.08);
  d = smooth_union(d, ellipsoid(q, {0, 0.70, 0.165}, {0.125, 0.080, 0.115}), 0.07);
  const Vec3 m = mirrored(q);
  d = smooth_union(d, round_cone(m, {{0.075, 0.90, 0.0}, 0.045}, {{0.105, 0.985, -0.035}, 0.034}), 0.03);
  d = smooth_union(d, round_cone(q, {{0, 0.90, -0.06}, 0.048}, {{0, 0.955, -0.105}, 0.024}), 0.03);
  return smooth_union(d, round_cone(q, {{0, 0.82, -0.12}, 0.050}, {{0, 0.855, -0.195}, 0.024}), 0.03);
}

double Creature::ear(const Vec3& q) const {
  const Vec3 m = mirrored(q);
  const Mat3 axes = turned(0, 12, -20);
  double d = ellipsoid(m, {0.285, 0.785, -0.01}, {0.155, 0.082, 0.045}, axes);
  return smooth_difference(d, ellipsoid(m, {0.305, 0.782, 0.047}, {0.105, 0.048, 0.028}, axes), 0.02);
}

double Creature::with_face(double d, const Vec3& q) const {
  const Vec3 m = mirrored(q);
  d += smile_depth(q, {0.80, 0.138, 0.85, 0.1, 0.0080, 0.010});
  d = smooth_difference(d, sphere(m, {0.108, 0.712, 0.205}, 0.012), 0.015);  // dimples
  d = smooth_union(d, ellipsoid(m, {0.048, 0.745, 0.252}, {0.030, 0.022, 0.026}), 0.02);
  return smooth_difference(d, sphere(m, {0.050, 0.748, 0.278}, 0.013), 0.01);
}

Eye Creature::eye_shape() {
  Eye eye;
  eye.center = kEye;
  eye.radius = kEyeRadius;
  eye.look = Vec3(0.14, 0.02, 1.0).normalized();
  eye.lid_normal = Vec3(0.22, 1.0, 0.10).normalized();
  eye.upper = 0.052;
  eye.lower = 0.060;
  eye.pupil = 0.031;
  eye.ramp = 0.011;
  return eye;
}

double Creature::with_eyes(double d, const Vec3& q) const {
  return smooth_union(d, eye_ball(mirrored(q), eye_shape()), 0.015);
}

double Creature::head(const Vec3& p) const {
  const Vec3 q = to_head(p);
  return kHeadScale * with_eyes(with_face(smooth_union(skull(q), ear(q), 0.04), q), q);
}

/// 1 within `edge` of a distance below 0, falling to 0 over `fade`.
double inside(double distance, double fade) {
  const double t = std::clamp(0.5 - distance / fade, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Vec3 mixed(const Vec3& a, const Vec3& b, double share) {
  return a + share * (b - a);
}

double Creature::horns(const Vec3& q) {
  const Vec3 m = mirrored(q);
  double d = round_cone(m, {{0.085, 0.935, -0.015}, 0.038}, {{0.105, 0.985, -0.035}, 0.040});
  d = std::min(d, round_cone(q, {{0, 0.925, -0.08}, 0.034}, {{0, 0.955, -0.105}, 0.034}));
  return std::min(d, round_cone(q, {{0, 0.845, -0.16}, 0.034}, {{0, 0.855, -0.195}, 0.034}));
}

Vec3 Creature::eye_color(const Vec3& q) {
  const Eye eye = eye_shape();
  const Vec3 to = (mirrored(q) - kEye).normalized();
  const double angle = std::acos(std::clamp(to.dot(eye.look), -1.0, 1.0));
  const Vec3 white(0.96, 0.95, 0.91), amber(0.93, 0.62, 0.13), black(0.05, 0.05, 0.06);
  const Vec3 c = mixed(mixed(white, amber, inside(angle - 0.66, 0.05)), black, inside(angle - 0.43, 0.05));
  const Vec3 side = eye.lid_normal.cross(eye.look).normalized();
  const Vec3 spark = (eye.radius * eye.look + 0.42 * eye.pupil * (eye.lid_normal - side)).normalized();
  return mixed(c, white, inside((to - spark).norm() - 0.36 * eye.pupil / eye.radius, 0.04));
}

Vec3 Creature::color(const Vec3& p) const {
  const Vec3 q = to_head(p), m = mirrored(q);
  Vec3 c = mixed(Vec3(0.25, 0.58, 0.47), Vec3(0.46, 0.72, 0.42), std::clamp(0.5 + 2.5 * p.z(), 0.0, 1.0));
  // Darker spots on the back, their places drawn from a spiral.
  for (int k = 0; k < 46; ++k) {
    const double turn = 2.399963 * k, height = 0.12 + 0.021 * k;
    const Vec3 spot(0.17 * std::sin(turn), height, -0.13 - 0.05 * std::cos(1.7 * turn));
    c = mixed(c, Vec3(0.16, 0.42, 0.40), 0.8 * inside((p - spot).norm() - 0.030 - 0.008 * std::sin(5.0 * k), 0.012));
  }
  const double belly = ellipsoid(p, {0, 0.325, 0.15}, {0.135, 0.175, 0.13});
  const double throat = ellipsoid(q, {0, 0.665, 0.20}, {0.11, 0.055, 0.12});
  c = mixed(c, Vec3(0.95, 0.88, 0.66), inside(std::min(belly, throat), 0.035));
  c = mixed(c, Vec3(0.93, 0.52, 0.43), 0.75 * inside((m - Vec3(0.160, 0.715, 0.160)).norm() - 0.035, 0.05));
  c = mixed(c, Vec3(0.94, 0.62, 0.52),
            inside(ellipsoid(m, {0.305, 0.782, 0.047}, {0.1, 0.046, 0.04}, turned(0, 12, -20)), 0.02));
  const double bright = std::min({horns(q) - 0.006, crest(p) - 0.008, tail_leaf(p) - 0.008});
  c = mixed(c, Vec3(0.96, 0.56, 0.22), inside(bright, 0.014));
  const Vec3 f = mirrored(p);
  for (int toe = -1; toe <= 1; ++toe) {
    const Vec3 nail(0.178 + 0.062 * toe, 0.045, 0.206 - 0.018 * std::abs(toe) - 0.010 * toe);
    c = mixed(c, Vec3(0.97, 0.91, 0.76), inside((f - nail).norm() - 0.024, 0.01));
  }
  return mixed(c, eye_color(q), inside(eye(p) - 0.0025, 0.003));
}

double Creature::operator()(const Vec3& p) const {
  double d = trunk(p);
  d = smooth_union(d, feet(p), 0.05);
  d = smooth_union(d, tail_(p), 0.08);
  d = smooth_union(d, tail_leaf(p), 0.03);
  d = smooth_union(d, neck_(p), 0.06);
  d = smooth_union(d, std::min(left_arm(p), right_arm(p)), 0.035);
  d = smooth_union(d, crest(p), 0.03);
  return smooth_union(d, head(p), 0.05);
}

}  // namespace

Sculpture make_creature() {
  const auto creature = std::make_shared<Creature>();
  Sculpture s;
  s.name = "creature";
  s.distance = [creature](const Vec3& p) { return (*creature)(p); };
  s.bounds.add({-0.56, -0.04, -0.53});
  s.bounds.add({0.58, 1.13, 0.42});
  s.cell = 0.0112;
  s.color = [creature](const Vec3& p) { return creature->color(p); };
  s.lenses = {
      {{0.0, 0.80, 0.18}, 0.36, 0.45}, {Creature::eye_center(1), 0.15, 0.45}, {Creature::eye_center(-1), 0.15, 0.45}};
  s.parts = {{"feet", [](const Vec3& p) { return p.y() < 0.05; }},
             {"knees", [](const Vec3& p) { return p.y() > 0.10 && p.y() < 0.20 && p.z() > -0.12; }},
             {"arms", [creature](const Vec3& p) { return std::abs(p.x()) > 0.17 && creature->arms(p) < 0.01; }},
             {"tail", [](const Vec3& p) { return p.z() < -0.2 && p.y() < 0.42; }},
             {"head", [creature](const Vec3& p) { return p.y() > 0.6 && creature->head(p) < 0.005; }},
             {"crown", [](const Vec3& p) { return p.y() > 0.84 && std::abs(p.x()) < 0.2; }},
             {"ears", [](const Vec3& p) { return std::abs(Creature::to_head(p).x()) > 0.21 && p.y() > 0.68; }},
             {"eyes", [](const Vec3& p) { return Creature::eye(p) < 0.002; }}};
  return s;
}

}  // namespace softreel::sculpt
