#include <algorithm>
#include <cmath>

#include "assets/generator/distance.h"
#include "assets/generator/sculpture.h"

namespace softreel::sculpt {

namespace {

constexpr double kTile = 0.125;  // m, edge of the quilt's tiles

/// Distance from x to the nearest seam between tiles.
double to_seam(double x) {
  return std::abs(x / kTile - std::round(x / kTile)) * kTile;
}

/// Depth of a seam's groove at a distance from its line: a smooth valley 0.03 m wide.
double groove(double x) {
  const double t = std::clamp(1 - to_seam(x) / 0.015, 0.0, 1.0);
  return 0.007 * t * t * (3 - 2 * t);
}

double quilted_bar(const Vec3& p) {
  const Vec3 half(0.5, 0.125, 0.125);
  const double box = rounded_box(p, half, 0.022);
  // Each face has the seams of its own two directions; a coordinate normal to the face makes none.
  double depth = 0;
  const Vec3 inset = p.cwiseAbs() - half;
  for (int k = 0; k < 3; ++k) {
    const double on_side = std::clamp(-inset[k] / 0.03, 0.0, 1.0);  // fades out where the face turns to k's own
    depth = std::max(depth, on_side * groove(p[k]));
  }
  return box + depth;
}

/// Box mapping: each side lies flat in the picture, which is four tiles wide.
Vec2 box_mapped(const Vec3& p, const Vec3& normal) {
  const Vec3 n = normal.cwiseAbs();
  const double picture = 4 * kTile;
  if (n.x() > n.y() && n.x() > n.z()) return Vec2(std::copysign(1.0, normal.x()) * -p.z(), p.y()) / picture;
  if (n.y() > n.z()) return Vec2(p.x(), std::copysign(1.0, normal.y()) * -p.z()) / picture;
  return Vec2(std::copysign(1.0, normal.z()) * p.x(), p.y()) / picture;
}

}  // namespace

Sculpture make_bar() {
  Sculpture s;
  s.name = "bar";
  s.distance = quilted_bar;
  s.bounds.add({-0.53, -0.155, -0.155});
  s.bounds.add({0.53, 0.155, 0.155});
  s.cell = 0.0075;
  s.texture_coordinate = box_mapped;
  s.parts = {{"left", [](const Vec3& p) { return p.x() < -0.44; }},
             {"middle", [](const Vec3& p) { return std::abs(p.x()) < 0.0625; }},
             {"right", [](const Vec3& p) { return p.x() > 0.44; }}};
  return s;
}

}  // namespace softreel::sculpt
