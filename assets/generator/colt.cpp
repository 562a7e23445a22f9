#include <algorithm>
#include <cmath>
#include <memory>

#include "assets/generator/distance.h"
#include "assets/generator/features.h"
#include "assets/generator/sculpture.h"

namespace softreel::sculpt {

namespace {

/// The foal, about 1.15 m tall, hooves on y = 0, facing +z.
class Colt {
 public:
  Colt();
  double operator()(const Vec3& p) const;
  double head(const Vec3& p) const;
  double tail(const Vec3& p) const { return tail_(p); }

 private:
  double trunk(const Vec3& p) const;
  double legs(const Vec3& p) const;
  double mane(const Vec3& p) const;
  static double mouth_depth(const Vec3& m);

  Limb fore_{{{{0.085, 0.64, 0.215}, 0.100},
              {{0.095, 0.50, 0.195}, 0.072},
              {{0.095, 0.40, 0.205}, 0.048},
              {{0.092, 0.30, 0.215}, 0.048},
              {{0.092, 0.20, 0.210}, 0.036},
              {{0.092, 0.115, 0.205}, 0.039},
              {{0.092, 0.05, 0.228}, 0.040}}};
  Limb hind_{{{{0.080, 0.66, -0.225}, 0.125},
              {{0.100, 0.50, -0.190}, 0.090},
              {{0.098, 0.40, -0.235}, 0.056},
              {{0.095, 0.315, -0.290}, 0.048},
              {{0.095, 0.21, -0.290}, 0.038},
              {{0.095, 0.115, -0.285}, 0.040},
              {{0.095, 0.05, -0.262}, 0.041}}};
  Limb neck_{{{{0, 0.66, 0.16}, 0.150}, {{0, 0.78, 0.275}, 0.112}, {{0, 0.90, 0.335}, 0.085}, {{0, 1.0, 0.36}, 0.085}}};
  Limb tail_{{{{0, 0.75, -0.32}, 0.050},
              {{0, 0.755, -0.40}, 0.044},
              {{0.005, 0.66, -0.465}, 0.056},
              {{0.015, 0.50, -0.480}, 0.060},
              {{0.03, 0.37, -0.455}, 0.040},
              {{0.045, 0.31, -0.475}, 0.024}}};
  Eye eye_;
};

Colt::Colt() {
  eye_.center = {0.066, 1.000, 0.445};
  eye_.radius = 0.047;
  eye_.look = Vec3(0.75, 0.0, 0.66).normalized();
  eye_.lid_normal = Vec3(0.05, 1.0, 0.15).normalized();
  eye_.upper = 0.026;
  eye_.lower = 0.032;
  eye_.pupil = 0.025;
  eye_.ramp = 0.009;
}

/// The slit of the mouth: a line along the side of the muzzle, seen from the side.
double Colt::mouth_depth(const Vec3& m) {
  const Vec2 a(0.600, 0.838), b(0.515, 0.872), p(m.z(), m.y());
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  const double off = (p - a - t * (b - a)).norm() / 0.008;
  return 0.009 * std::exp(-off * off);
}

double Colt::trunk(const Vec3& p) const {
  double d = ellipsoid(p, {0, 0.635, -0.01}, {0.150, 0.160, 0.31});
  d = smooth_union(d, ellipsoid(p, {0, 0.64, 0.20}, {0.135, 0.170, 0.14}), 0.10);
  d = smooth_union(d, ellipsoid(mirrored(p), {0.055, 0.665, -0.235}, {0.105, 0.145, 0.14}), 0.08);
  d = smooth_union(d, neck_(p), 0.08);
  return smooth_union(d, tail_(p), 0.035);
}

double Colt::legs(const Vec3& p) const {
  const Vec3 q = mirrored(p);
  const double fore_hoof = round_cone(q, {{0.092, 0.020, 0.250}, 0.056}, {{0.092, 0.062, 0.236}, 0.043});
  const double hind_hoof = round_cone(q, {{0.095, 0.020, -0.240}, 0.056}, {{0.095, 0.062, -0.254}, 0.044});
  double d = std::min(smooth_union(fore_(q), fore_hoof, 0.006), smooth_union(hind_(q), hind_hoof, 0.006));
  d = smooth_union(d, ellipsoid(q, {0.092, 0.30, 0.225}, {0.046, 0.052, 0.045}), 0.02);    // knee cap
  d = smooth_union(d, ellipsoid(q, {0.095, 0.335, -0.312}, {0.036, 0.045, 0.036}), 0.02);  // point of the hock
  return smooth_intersection(d, -p.y(), 0.012);
}

double Colt::mane(const Vec3& p) const {
  // Upright tufts along the crest of the neck, the last one falls over the forehead.
  const Station root[] = {{{0, 0.80, 0.175}, 0.044},  {{0, 0.865, 0.215}, 0.046}, {{0, 0.93, 0.250}, 0.047},
                          {{0, 0.995, 0.275}, 0.047}, {{0, 1.055, 0.305}, 0.047}, {{0, 1.095, 0.350}, 0.044}};
  double d = 1e300;
  for (const Station& s : root) {
    const Vec3 lean = 0.055 * Vec3(0, 0.55 + 2.2 * (s.position.y() - 0.95), -0.9).normalized();
    d = smooth_union(d, round_cone(p, s, {s.position + lean, 0.024}), 0.012);
  }
  return smooth_union(d, round_cone(p, {{0, 1.085, 0.40}, 0.042}, {{0.012, 1.045, 0.462}, 0.022}), 0.02);
}

double Colt::head(const Vec3& p) const {
  const Vec3 m = mirrored(p);
  double d = ellipsoid(p, {0, 1.005, 0.395}, {0.098, 0.105, 0.115});
  d = smooth_union(d, ellipsoid(m, {0.040, 0.945, 0.405}, {0.055, 0.075, 0.075}), 0.05);                // cheeks
  d = smooth_union(d, round_cone(p, {{0, 0.955, 0.43}, 0.078}, {{0, 0.875, 0.555}, 0.056}), 0.04);      // nose
  d = smooth_union(d, ellipsoid(p, {0, 0.862, 0.565}, {0.066, 0.056, 0.058}, turned(35, 0, 0)), 0.03);  // muzzle
  d = smooth_union(d, ellipsoid(m, {0.034, 0.893, 0.600}, {0.024, 0.022, 0.022}), 0.02);
  d = smooth_difference(d, sphere(m, {0.043, 0.897, 0.621}, 0.013), 0.012);
  d += mouth_depth(m);
  d = smooth_union(d, eye_ball(m, eye_), 0.012);
  const Mat3 axes = turned(-12, 20, -24);
  double ear = ellipsoid(m, {0.088, 1.145, 0.345}, {0.044, 0.105, 0.036}, axes);
  ear = smooth_difference(ear, ellipsoid(m, {0.094, 1.150, 0.382}, {0.024, 0.070, 0.016}, axes), 0.012);
  return smooth_union(d, ear, 0.025);
}

double Colt::operator()(const Vec3& p) const {
  double d = smooth_union(trunk(p), legs(p), 0.06);
  d = smooth_union(d, head(p), 0.04);
  return smooth_union(d, mane(p), 0.015);
}

bool between(double low, double x, double high) {
  return low < x && x < high;
}

}  // namespace

Sculpture make_colt() {
  const auto colt = std::make_shared<Colt>();
  Sculpture s;
  s.name = "colt";
  s.distance = [colt](const Vec3& p) { return (*colt)(p); };
  s.bounds.add({-0.26, -0.04, -0.60});
  s.bounds.add({0.26, 1.31, 0.70});
  s.cell = 0.0102;
  s.lenses = {{{0, 0.98, 0.48}, 0.30, 0.35}, {{0.085, 1.0, 0.46}, 0.09, 0.5}, {{-0.085, 1.0, 0.46}, 0.09, 0.5}};
  s.parts = {{"hooves_front", [](const Vec3& p) { return p.y() < 0.06 && p.z() > 0; }},
             {"hooves_hind", [](const Vec3& p) { return p.y() < 0.06 && p.z() < 0; }},
             {"legs", [](const Vec3& p) { return p.y() < 0.44 && std::abs(p.z()) < 0.37; }},
             {"knees",
              [](const Vec3& p) {
                return (p.z() > 0 ? between(0.245, p.y(), 0.355) : between(0.26, p.y(), 0.37)) &&
                       std::abs(p.z()) < 0.37;
              }},
             {"fetlocks", [](const Vec3& p) { return between(0.085, p.y(), 0.15); }},
             {"shoulders", [](const Vec3& p) { return between(0.56, p.y(), 0.80) && between(0.10, p.z(), 0.34); }},
             {"head", [colt](const Vec3& p) { return p.z() > 0.30 && colt->head(p) < 0.01; }},
             {"tail", [colt](const Vec3& p) { return p.z() < -0.38 && colt->tail(p) < 0.01; }}};
  return s;
}

}  // namespace softreel::sculpt
