/// rotation_curvature of many elements, a few at a time in vector lanes.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/types.h"
#include "core/elasticity/element.h"
#include "core/elasticity/element_lanes.h"

namespace softreel {

/// By lanes; matrices by rows, symmetric ones by their upper triangle.
struct alignas(32) CurvatureLanes {
  double rotation[9][kElementLanes], strain[6][kElementLanes];
  double pressure[kElementLanes], mu[kElementLanes];
  double curvature[6][kElementLanes];  ///< out
};

/// rotation_curvature of each lane, from the strain sym(Q^T F) - I.
void find_lane_curvatures(bool positive_part, CurvatureLanes& lanes);

/// Takes elements one by one, and adds to their matrices whenever it has a batch of them, and in the end. Matrices must
/// stay where they are until then.
class CurvatureBatch {
 public:
  explicit CurvatureBatch(bool positive_part) : positive_part_(positive_part) {}

  /// matrix += factor times rotation_curvature of an element with this strain.
  void add(const ElasticLaw& law, const Mat3& rotation, const Mat3& strain, double factor, Mat3& matrix);
  void finish();

 private:
  bool positive_part_;
  std::size_t count_ = 0;
  CurvatureLanes lanes_ = {};
  std::array<double, kElementLanes> factors_ = {};
  std::array<Mat3*, kElementLanes> matrices_ = {};
};

}  // namespace softreel
