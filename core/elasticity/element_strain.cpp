#include "core/elasticity/element_strain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace softreel {

Mat3 deformation_gradient(const std::array<Vec3, 4>& rest, const std::array<Vec3, 4>& deformed) {
  Mat3 from, to;
  for (int k = 0; k < 3; ++k) {
    from.col(k) = rest[static_cast<std::size_t>(k) + 1] - rest[0];
    to.col(k) = deformed[static_cast<std::size_t>(k) + 1] - deformed[0];
  }
  return to * from.inverse();
}

Vec3 principal_stretches(const Mat3& gradient) {
  // Of F^T F - I, whose eigenvalues are small with the strains and lose no digits in the difference.
  const Mat3 twice_green = gradient.transpose() * gradient - Mat3::Identity();
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(twice_green, Eigen::EigenvaluesOnly);
  Vec3 stretches = (solver.eigenvalues().array() + 1).cwiseMax(0.0).sqrt();
  if (gradient.determinant() < 0) stretches[0] = -stretches[0];
  return stretches;
}

double largest_strain(const Vec3& stretches) {
  return (stretches.array() - 1).abs().maxCoeff();
}

double von_mises_stress(const Vec3& stretches, const ElementMaterial& material) {
  // The deviator knows no pressure: 2 mu times that of the strain.
  const Vec3 deviator = (stretches.array() - stretches.mean()).matrix();
  return 2 * material.lame_mu() * std::sqrt(1.5) * deviator.norm();
}

Mat3 green_strain(const Mat3& gradient) {
  return 0.5 * (gradient.transpose() * gradient - Mat3::Identity());
}

Mat3 cauchy_stress(const Mat3& first_piola, const Mat3& gradient) {
  const double volume_ratio = gradient.determinant();
  if (volume_ratio == 0) return Mat3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Mat3 stress = first_piola * gradient.transpose() / volume_ratio;
  return 0.5 * (stress + stress.transpose());
}

double von_mises_of(const Mat3& stress) {
  const Mat3 deviator = stress - stress.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

}  // namespace softreel
