#include "core/elasticity/element_strain.h"

#include <algorithm>
#include <cmath>

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

}  // namespace softreel
