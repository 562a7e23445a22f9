#include "core/elasticity/curvature_batch.h"

namespace softreel {
namespace {

/// Places of the upper triangle.
constexpr std::array<std::array<int, 2>, 6> kUpper{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

}  // namespace

void CurvatureBatch::add(const ElasticLaw& law, const Mat3& rotation, const Mat3& strain, double factor, Mat3& matrix) {
  const std::size_t lane = count_++;
  for (std::size_t k = 0; k < 9; ++k)
    lanes_.rotation[k][lane] = rotation(static_cast<int>(k / 3), static_cast<int>(k % 3));
  for (std::size_t k = 0; k < 6; ++k) lanes_.strain[k][lane] = strain(kUpper[k][0], kUpper[k][1]);
  lanes_.pressure[lane] = law.pressure(strain.trace());
  lanes_.mu[lane] = law.mu;
  factors_[lane] = factor;
  matrices_[lane] = &matrix;
  if (count_ == kElementLanes) finish();
}

void CurvatureBatch::finish() {
  if (count_ == 0) return;
  find_lane_curvatures(positive_part_, lanes_);  // of lanes without an element, what they held before
  for (std::size_t lane = 0; lane < count_; ++lane) {
    Mat3& matrix = *matrices_[lane];
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [i, j] = kUpper[k];
      const double value = factors_[lane] * lanes_.curvature[k][lane];
      matrix(i, j) += value;
      if (i != j) matrix(j, i) += value;
    }
  }
  count_ = 0;
}

}  // namespace softreel
