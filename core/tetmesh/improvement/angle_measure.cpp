#include "core/tetmesh/improvement/angle_measure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace softreel {
namespace {

/// A determinant of differences is right to 8 units of round-off times the product of their lengths (Shewchuk, Adaptive
/// Precision Floating-Point Arithmetic, 1997, orient3d).
constexpr double kDeterminantError = 8 * 1.2e-16;

double cosine_of(double degrees) {
  return std::cos(degrees * std::numbers::pi / 180);
}

}  // namespace

DihedralCosines dihedral_cosines(const TetCorners& x) {
  const Vec3 ab = x[1] - x[0], ac = x[2] - x[0], ad = x[3] - x[0], bc = x[2] - x[1], bd = x[3] - x[1];
  std::array<Vec3, 4> normals{bc.cross(bd), ad.cross(ac), ab.cross(ad), ac.cross(ab)};  // outward
  DihedralCosines cosines{-1, 1};
  const double determinant = -normals[3].dot(ad);
  const double reach = ab.squaredNorm() * ac.squaredNorm() * ad.squaredNorm();
  cosines.positive = determinant > 0 && determinant * determinant > kDeterminantError * kDeterminantError * reach;
  for (Vec3& normal : normals) normal /= normal.norm();
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = -normals[i].dot(normals[j]);
      if (!(cosine <= cosines.of_least)) cosines.of_least = cosine;
      if (!(cosine >= cosines.of_largest)) cosines.of_largest = cosine;
    }
  return cosines;
}

AngleMeasure::AngleMeasure(double least_target, double largest_target)
    : least_weight_(1 / (1 - cosine_of(least_target))), largest_weight_(1 / (1 + cosine_of(largest_target))) {}

void AngleMeasure::admit(const DihedralCosines& cosines) {
  admitted_.of_least = std::max(admitted_.of_least, cosines.of_least);
  admitted_.of_largest = std::min(admitted_.of_largest, cosines.of_largest);
}

double AngleMeasure::quality(const DihedralCosines& cosines) const {
  const double worse = std::min(least_weight_ * (1 - cosines.of_least), largest_weight_ * (1 + cosines.of_largest));
  return cosines.positive && worse >= 0 ? worse : kFlat;
}

double AngleMeasure::new_quality(const TetCorners& x) const {
  const DihedralCosines cosines = dihedral_cosines(x);
  const bool admitted = cosines.of_least <= admitted_.of_least && cosines.of_largest >= admitted_.of_largest;
  return admitted ? quality(cosines) : kFlat;
}

}  // namespace softreel
