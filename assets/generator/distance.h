/// Signed distances of the solids that the sculptures are blended from.
///
/// Negative inside. Those of ellipsoids and blends are bounds rather than distances, but their zero sets are exact; the
/// formulas for the round cone and the ellipsoid are in I. Quilez, "Distance functions" (2008-2020).
#pragma once

#include <vector>

#include "core/base/types.h"

namespace softreel::sculpt {

double sphere(const Vec3& p, const Vec3& center, double radius);

/// Axis-aligned; first-order exact near its surface.
double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii);

/// The same, its axes turned by `axes` (columns: the directions of radii x, y, z).
double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii, const Mat3& axes);

/// Box of half sizes `half`, its edges rounded by `radius` (within the half sizes).
double rounded_box(const Vec3& p, const Vec3& half, double radius);

/// One station of a limb.
struct Station {
  Vec3 position;
  double radius = 0;
};

/// The hull of two spheres.
double round_cone(const Vec3& p, const Station& a, const Station& b);

/// A tube along a smooth curve through its stations: Catmull-Rom in position and radius, cut into round cones.
class Limb {
 public:
  /// At least two stations.
  explicit Limb(const std::vector<Station>& stations);
  double operator()(const Vec3& p) const;

 private:
  std::vector<Station> samples_;
  Vec3 center_ = Vec3::Zero();  ///< of a sphere around the limb: far points are measured to that
  double reach_ = 0;
};

/// Union that rounds the seam over a zone `blend` wide; 0: a sharp union.
double smooth_union(double a, double b, double blend);

/// `a` without `b`, with a rounded rim.
double smooth_difference(double a, double b, double blend);

/// What both have, with a rounded rim.
double smooth_intersection(double a, double b, double blend);

/// (|x|, y, z): describes both halves of something symmetric by its left one.
Vec3 mirrored(const Vec3& p);

/// (-x, y, z) of each station: the right limb from the left one.
std::vector<Station> reflected(std::vector<Station> stations);

/// Rotation about the axes x, then y, then z, in degrees.
Mat3 turned(double x_deg, double y_deg, double z_deg);

}  // namespace softreel::sculpt
