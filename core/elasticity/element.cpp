#include "core/elasticity/element.h"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace softreel {

ElementShape find_element_shape(const TetNodes& rest) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = rest[static_cast<std::size_t>(k) + 1] - rest[0];
  const double determinant = edges.determinant();
  // Rows of the inverse by cross products: b_1 = e_2 x e_3 / det and so on.
  ElementShape shape;
  shape.gradients.col(1) = edges.col(1).cross(edges.col(2)) / determinant;
  shape.gradients.col(2) = edges.col(2).cross(edges.col(0)) / determinant;
  shape.gradients.col(3) = edges.col(0).cross(edges.col(1)) / determinant;
  shape.gradients.col(0) = -(shape.gradients.col(1) + shape.gradients.col(2) + shape.gradients.col(3));
  shape.volume = determinant / 6.0;
  return shape;
}

Mat3 deformation_gradient(const Gradients& gradients, const TetNodes& positions) {
  return (positions[1] - positions[0]) * gradients.col(1).transpose() +
         (positions[2] - positions[0]) * gradients.col(2).transpose() +
         (positions[3] - positions[0]) * gradients.col(3).transpose();
}

double ElasticLaw::pressure_energy(double trace) const {
  if (!at_limit(trace)) return 0.5 * lambda * trace * trace;
  return pressure_limit() * (trace - 0.5 * pressure_limit() / lambda);
}

Mat3 corotated_strain(const Mat3& rotation, const Mat3& F) {
  const Mat3 stretch = rotation.transpose() * F;
  return 0.5 * (stretch + stretch.transpose()) - Mat3::Identity();
}

Mat3 corotated_stress(const ElasticLaw& law, const Mat3& rotation, const Mat3& F) {
  const Mat3 strain = corotated_strain(rotation, F);
  return rotation * (2 * law.mu * strain + law.pressure(strain.trace()) * Mat3::Identity());
}

double corotated_energy(const ElasticLaw& law, const Mat3& rotation, const Mat3& F) {
  const Mat3 strain = corotated_strain(rotation, F);
  return law.mu * strain.squaredNorm() + law.pressure_energy(strain.trace());
}

Eigen::Matrix<double, 12, 12> element_stiffness(const ElementShape& shape, double lambda, double mu,
                                                const Mat3& rotation) {
  const Gradients a = rotation * shape.gradients;
  Eigen::Matrix<double, 12, 12> stiffness;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      stiffness.block<3, 3>(3 * i, 3 * j) =
          shape.volume * (lambda * a.col(i) * a.col(j).transpose() + mu * a.col(j) * a.col(i).transpose() +
                          mu * a.col(i).dot(a.col(j)) * Mat3::Identity());
  return stiffness;
}

Mat3 rotation_curvature(const ElasticLaw& law, const Mat3& rotation, const Mat3& F, bool positive_part) {
  const Mat3 strain = corotated_strain(rotation, F);
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(strain);
  const Mat3 axes = rotation * principal.eigenvectors();
  const Vec3 stretches = principal.eigenvalues() + Vec3::Ones();
  const double p = law.pressure(strain.trace());
  Mat3 curvature = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    const double sum = std::max(stretches[(k + 1) % 3] + stretches[(k + 2) % 3], kSmallestStretchSum);
    double kappa = 2 * law.mu - 2 * (2 * law.mu - p) / sum;
    if (positive_part) kappa = std::max(kappa, 0.0);
    curvature += 0.5 * kappa * axes.col(k) * axes.col(k).transpose();
  }
  return curvature;
}

}  // namespace softreel
