#include "core/elasticity/rotation_energy.h"

#include "core/elasticity/davenport.h"
#include "core/elasticity/element_rotation.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {
namespace {

double squares_about_center(const TetNodes& nodes) {
  const Vec3 center = 0.25 * (nodes[0] + nodes[1] + nodes[2] + nodes[3]);
  double sum = 0;
  for (const Vec3& node : nodes) sum += (node - center).squaredNorm();
  return sum;
}

Eigen::Matrix4d full_davenport(const Mat3& A) {
  const auto m = detail::davenport_matrix(
      detail::Matrix9<double>{A(0, 0), A(0, 1), A(0, 2), A(1, 0), A(1, 1), A(1, 2), A(2, 0), A(2, 1), A(2, 2)});
  Eigen::Matrix4d full;
  full << m[0], m[1], m[2], m[3], m[1], m[4], m[5], m[6], m[2], m[5], m[7], m[8], m[3], m[6], m[8], m[9];
  return full;
}

}  // namespace

RotationEnergy::RotationEnergy(const TetNodes& rest, const TetNodes& deformed)
    : davenport_(full_davenport(element_moment(rest, deformed).transpose())),
      weight_(tet_volume(rest[0], rest[1], rest[2], rest[3]) / 20),
      deformed_square_(squares_about_center(deformed)),
      rest_square_(squares_about_center(rest)) {}

double RotationEnergy::value(const Vec4& q, double multiplier) const {
  const double square = q.squaredNorm();
  return weight_ * (deformed_square_ * square * square - 2 * q.dot(davenport_ * q) + rest_square_) +
         multiplier * (square - 1);
}

Eigen::Matrix<double, 5, 1> RotationEnergy::gradient(const Vec4& q, double multiplier) const {
  Eigen::Matrix<double, 5, 1> gradient;
  gradient.head<4>() = 4 * weight_ * (deformed_square_ * q.squaredNorm() * q - davenport_ * q) + 2 * multiplier * q;
  gradient[4] = q.squaredNorm() - 1;
  return gradient;
}

Eigen::Matrix<double, 5, 5> RotationEnergy::hessian(const Vec4& q, double multiplier) const {
  Eigen::Matrix<double, 5, 5> hessian;
  hessian.topLeftCorner<4, 4>() =
      4 * weight_ *
          (deformed_square_ * (q.squaredNorm() * Eigen::Matrix4d::Identity() + 2 * q * q.transpose()) - davenport_) +
      2 * multiplier * Eigen::Matrix4d::Identity();
  hessian.topRightCorner<4, 1>() = 2 * q;
  hessian.bottomLeftCorner<1, 4>() = 2 * q.transpose();
  hessian(4, 4) = 0;
  return hessian;
}

double RotationEnergy::multiplier(const Vec4& unit_q) const {
  return 2 * weight_ * (unit_q.dot(davenport_ * unit_q) - deformed_square_);
}

}  // namespace softreel
