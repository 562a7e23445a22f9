/// One number for how far the dihedral angles of a tetrahedron are from what is wanted.
///
/// Cosines instead of sines (Freitag and Ollivier-Gooch, Tetrahedral Mesh Improvement Using Swapping and Smoothing,
/// 1997; Klingner and Shewchuk, Aggressive Tetrahedral Mesh Improvement, 2007, weigh the sines of obtuse angles by
/// 0.7): 1 - cos and 1 + cos are smooth and monotone from 0 to 180 degrees, so that small and large angles get a weight
/// each without a jump at 90.
#pragma once

#include <array>

#include "core/base/types.h"

namespace softreel {

/// The four corners of an element, positively oriented if det[x1-x0, x2-x0, x3-x0] > 0.
using TetCorners = std::array<Vec3, 4>;

/// The cosines of the least and of the largest dihedral angle.
struct DihedralCosines {
  double of_least = 1, of_largest = -1;
  bool positive = false;  ///< the volume is beyond doubt: larger than the round-off of its determinant
};

/// NaN for an element with a face without area.
DihedralCosines dihedral_cosines(const TetCorners& x);

/// Quality 1: the worse of the two angles is at its target; above 1: better than that. Near 0 it is the square of the
/// share of the target that the angle (or 180 degrees less the angle) reaches.
class AngleMeasure {
 public:
  /// Targets in degrees, between 0 and 90, and 90 and 180.
  AngleMeasure(double least_target, double largest_target);

  /// No new element may have angles beyond those of the elements that are shown to this.
  void admit(const DihedralCosines& cosines);

  /// Of an element that is there. kFlat where the volume is not positive beyond doubt.
  double quality(const DihedralCosines& cosines) const;
  double quality(const TetCorners& x) const { return quality(dihedral_cosines(x)); }

  /// Of an element that may come: kFlat too if its angles are beyond the admitted ones.
  double new_quality(const TetCorners& x) const;

  double least_weight() const { return least_weight_; }      ///< quality = weight (1 - cosine) of the least angle
  double largest_weight() const { return largest_weight_; }  ///< quality = weight (1 + cosine) of the largest

  static constexpr double kFlat = -1;

 private:
  double least_weight_, largest_weight_;
  DihedralCosines admitted_{-1, 1, true};
};

/// A change must bring the worst quality above this, or it is not made: 1 % of the angle.
inline double worthwhile(double quality) {
  return quality < 0 ? 0 : 1.02 * quality;
}

}  // namespace softreel
