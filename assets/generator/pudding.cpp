#include <algorithm>
#include <cmath>
#include <numbers>

#include "assets/generator/distance.h"
#include "assets/generator/sculpture.h"

namespace softreel::sculpt {

namespace {

constexpr int kFlutes = 12;

/// A tier of the mould: a cone frustum with round edges whose side waves, between two heights.
struct Tier {
  double bottom = 0, top = 0;                ///< m
  double bottom_radius = 0, top_radius = 0;  ///< m, to the crests of the flutes
  double depth = 0;                          ///< m, of the flutes
  double phase = 0;                          ///< of the first flute, in flutes
};

/// The side as a bound: the distance in the horizontal plane, shortened by the slope of the waves.
double fluted_tier(const Vec3& p, const Tier& tier) {
  const double rho = std::hypot(p.x(), p.z());
  const double share = std::clamp((p.y() - tier.bottom) / (tier.top - tier.bottom), 0.0, 1.0);
  const double crest = tier.bottom_radius + share * (tier.top_radius - tier.bottom_radius);
  // |cos| has round crests and sharp valleys, as metal moulds have; the power makes the valleys round too.
  const double wave = std::cos(0.5 * kFlutes * std::atan2(p.z(), p.x()) + tier.phase * std::numbers::pi);
  const double valley = 1 - std::sqrt(wave * wave + 0.02);
  const double side = 0.8 * (rho - (crest - tier.depth * std::max(0.0, valley)));
  const double height = std::max(tier.bottom - p.y(), p.y() - tier.top);
  return smooth_intersection(side, height, 0.06);
}

double pudding(const Vec3& p) {
  const double base = fluted_tier(p, {0.0, 0.20, 0.46, 0.42, 0.045, 0.0});
  const double middle = fluted_tier(p, {0.10, 0.42, 0.37, 0.30, 0.040, 0.5});
  const double dome = ellipsoid(p, {0, 0.41, 0}, {0.235, 0.17, 0.235});
  const double dimple = sphere(p, {0, 0.685, 0}, 0.135);
  return smooth_difference(smooth_union(smooth_union(base, middle, 0.03), dome, 0.03), dimple, 0.03);
}

}  // namespace

Sculpture make_pudding() {
  Sculpture s;
  s.name = "pudding";
  s.distance = pudding;
  s.bounds.add({-0.52, -0.05, -0.52});
  s.bounds.add({0.52, 0.64, 0.52});
  s.cell = 0.0095;
  s.parts = {{"sole", [](const Vec3& p) { return p.y() < 0.012; }},
             {"top", [](const Vec3& p) { return p.y() > 0.50; }}};
  return s;
}

}  // namespace softreel::sculpt
