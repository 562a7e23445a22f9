/// The paper's rotation energy as it is written, eqs. (3)-(8): value, gradient and Hessian.
///
/// find_rotation solves the same problem as an eigenproblem and is what the simulation uses; this is the reference that
/// ties the two together; paper_rotation iterates on it as the paper does.
#pragma once

#include "core/base/types.h"
#include "core/elasticity/element.h"

namespace softreel {

/// E(q, l) = integral over the element of |q (x - c) q* - (X - c0)|^2 + l (q^T q - 1), eqs. (3) and (4).
///
/// Here, as in the paper, q = (w, x, y, z) describes Q^T, deformed to rest. Both shapes are centred and linear, so the
/// integral of y y^T is V/20 sum y_i y_i^T, and E = V/20 (s |q|^4 - 2 q^T N q + s0) + l (|q|^2 - 1), with
/// s = sum |x_i - c|^2, s0 = sum |X_i - c0|^2 and N Davenport's matrix of A^T, A = sum (x_i - c)(X_i - c0)^T.
class RotationEnergy {
 public:
  RotationEnergy(const TetNodes& rest, const TetNodes& deformed);

  /// Eq. (4), m^5.
  double value(const Vec4& q, double multiplier) const;
  /// Eqs. (5) and (6): derivatives by w, x, y, z and the multiplier.
  Eigen::Matrix<double, 5, 1> gradient(const Vec4& q, double multiplier) const;
  /// Eqs. (7) and (8): second derivatives; the last entry is zero.
  Eigen::Matrix<double, 5, 5> hessian(const Vec4& q, double multiplier) const;

  /// The multiplier at which the gradient by q vanishes for an eigenvector q of N with eigenvalue mu:
  /// 2 (V/20) (mu - s).
  double multiplier(const Vec4& unit_q) const;

 private:
  Eigen::Matrix4d davenport_;
  double weight_;           ///< V / 20, m^3
  double deformed_square_;  ///< s, m^2
  double rest_square_;      ///< s0, m^2
};

}  // namespace softreel
