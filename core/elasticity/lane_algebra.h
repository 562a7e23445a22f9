/// 3x3 matrices and quaternions of doubles or of vector lanes: the algebra that the element kernels share.
#pragma once

#include "core/elasticity/davenport.h"

namespace softreel::detail {

template <typename Real>
using Vector3 = std::array<Real, 3>;

/// A symmetric 3x3 matrix by its upper triangle: 00 01 02 11 12 22.
template <typename Real>
using Symmetric3 = std::array<Real, 6>;

/// Rotation matrix of a unit quaternion.
template <typename Real>
[[gnu::always_inline]] inline Matrix9<Real> rotation_matrix(const Quad<Real>& q) {
  const Real x = q[1] + q[1], y = q[2] + q[2], z = q[3] + q[3];
  const Real wx = q[0] * x, wy = q[0] * y, wz = q[0] * z;
  const Real xx = q[1] * x, xy = q[1] * y, xz = q[1] * z, yy = q[2] * y, yz = q[2] * z, zz = q[3] * z;
  const Real one(1);
  return {one - (yy + zz), xy - wz, xz + wy, xy + wz, one - (xx + zz), yz - wx, xz - wy, yz + wx, one - (xx + yy)};
}

/// A^T B.
template <typename Real>
[[gnu::always_inline]] inline Matrix9<Real> transposed_product(const Matrix9<Real>& A, const Matrix9<Real>& B) {
  Matrix9<Real> product;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) product[3 * r + c] = A[r] * B[c] + A[3 + r] * B[3 + c] + A[6 + r] * B[6 + c];
  return product;
}

/// A B for symmetric B.
template <typename Real>
[[gnu::always_inline]] inline Matrix9<Real> product(const Matrix9<Real>& A, const Symmetric3<Real>& B) {
  Matrix9<Real> result;
  for (std::size_t r = 0; r < 3; ++r) {
    const Real &x = A[3 * r], &y = A[3 * r + 1], &z = A[3 * r + 2];
    result[3 * r] = x * B[0] + y * B[1] + z * B[2];
    result[3 * r + 1] = x * B[1] + y * B[3] + z * B[4];
    result[3 * r + 2] = x * B[2] + y * B[4] + z * B[5];
  }
  return result;
}

/// A v.
template <typename Real>
[[gnu::always_inline]] inline Vector3<Real> product(const Matrix9<Real>& A, const Vector3<Real>& v) {
  return {A[0] * v[0] + A[1] * v[1] + A[2] * v[2], A[3] * v[0] + A[4] * v[1] + A[5] * v[2],
          A[6] * v[0] + A[7] * v[1] + A[8] * v[2]};
}

/// Half of A + A^T.
template <typename Real>
[[gnu::always_inline]] inline Symmetric3<Real> symmetric_part(const Matrix9<Real>& A) {
  const Real half(0.5);
  return {A[0], half * (A[1] + A[3]), half * (A[2] + A[6]), A[4], half * (A[5] + A[7]), A[8]};
}

/// A v = b by cofactors, and the leading minors of A, all positive exactly if A is positive definite.
template <typename Real>
struct CofactorSolution {
  Vector3<Real> v;
  Real minor1, minor2, minor3;
};

template <typename Real>
[[gnu::always_inline]] inline CofactorSolution<Real> solve_by_cofactors(const Symmetric3<Real>& A,
                                                                        const Vector3<Real>& b) {
  const Real c00 = A[3] * A[5] - A[4] * A[4], c01 = A[2] * A[4] - A[1] * A[5], c02 = A[1] * A[4] - A[2] * A[3];
  const Real c11 = A[0] * A[5] - A[2] * A[2], c12 = A[1] * A[2] - A[0] * A[4], c22 = A[0] * A[3] - A[1] * A[1];
  const Real determinant = A[0] * c00 + A[1] * c01 + A[2] * c02;
  const Real inverse = Real(1) / determinant;
  return {{(c00 * b[0] + c01 * b[1] + c02 * b[2]) * inverse, (c01 * b[0] + c11 * b[1] + c12 * b[2]) * inverse,
           (c02 * b[0] + c12 * b[1] + c22 * b[2]) * inverse},
          A[0],
          c22,
          determinant};
}

/// Product of the quaternions q and (1, half_turn), normalised: q turned by about 2 half_turn in its own frame.
template <typename Real, typename Sqrt>
[[gnu::always_inline]] inline Quad<Real> turned(const Quad<Real>& q, const Vector3<Real>& half_turn, const Sqrt& root) {
  const auto& [x, y, z] = half_turn;
  const Quad<Real> result{q[0] - (q[1] * x + q[2] * y + q[3] * z), q[1] + (q[0] * x + q[2] * z - q[3] * y),
                          q[2] + (q[0] * y + q[3] * x - q[1] * z), q[3] + (q[0] * z + q[1] * y - q[2] * x)};
  const Real scale = Real(1) / root(dot(result, result));
  return scaled(result, scale);
}

}  // namespace softreel::detail
