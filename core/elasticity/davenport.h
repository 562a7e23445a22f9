/// Davenport's symmetric 4x4 matrix N(A) and the algebra on it that finding a rotation needs; for doubles and for
/// lanes.
///
/// Davenport 1968 (q-method); Horn, Closed-form solution of absolute orientation using unit quaternions, 1987.
#pragma once

#include <array>

namespace softreel::detail {

/// A 3x3 matrix by rows, and a quaternion as (w, x, y, z), of doubles or of vector lanes.
template <typename Real>
using Matrix9 = std::array<Real, 9>;
template <typename Real>
using Quad = std::array<Real, 4>;

/// A symmetric 4x4 matrix by its upper triangle: 00 01 02 03 11 12 13 22 23 33.
template <typename Real>
using Symmetric4 = std::array<Real, 10>;

/// N(A) with q^T N q = tr(R(q)^T A) for unit q: its greatest eigenvector is the rotation nearest to A.
template <typename Real>
inline Symmetric4<Real> davenport_matrix(const Matrix9<Real>& A) {
  return {A[0] + A[4] + A[8], A[7] - A[5], A[2] - A[6],        A[3] - A[1], A[0] - A[4] - A[8],
          A[1] + A[3],        A[2] + A[6], A[4] - A[0] - A[8], A[5] + A[7], A[8] - A[0] - A[4]};
}

template <typename Real>
inline Quad<Real> multiply(const Symmetric4<Real>& m, const Quad<Real>& v) {
  return {(m[0] * v[0] + m[1] * v[1]) + (m[2] * v[2] + m[3] * v[3]),
          (m[1] * v[0] + m[4] * v[1]) + (m[5] * v[2] + m[6] * v[3]),
          (m[2] * v[0] + m[5] * v[1]) + (m[7] * v[2] + m[8] * v[3]),
          (m[3] * v[0] + m[6] * v[1]) + (m[8] * v[2] + m[9] * v[3])};
}

template <typename Real>
inline Real dot(const Quad<Real>& a, const Quad<Real>& b) {
  return (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
}

template <typename Real>
inline Quad<Real> scaled(const Quad<Real>& v, const Real& s) {
  return {v[0] * s, v[1] * s, v[2] * s, v[3] * s};
}

template <typename Real>
inline Symmetric4<Real> shifted(Symmetric4<Real> m, const Real& shift) {
  m[0] -= shift;
  m[4] -= shift;
  m[7] -= shift;
  m[9] -= shift;
  return m;
}

/// Adjugate: inverse times determinant, without a division. Of N - mu I with mu near an eigenvalue it is nearly the
/// projection on that eigenvector times the product of the other gaps, and zero where the eigenvalue is multiple.
template <typename Real>
inline Symmetric4<Real> adjugate(const Symmetric4<Real>& m) {
  const auto [m00, m01, m02, m03, m11, m12, m13, m22, m23, m33] = m;
  const Real s0 = m00 * m11 - m01 * m01, s1 = m00 * m12 - m01 * m02, s2 = m00 * m13 - m01 * m03;
  const Real s3 = m01 * m12 - m11 * m02, s4 = m01 * m13 - m11 * m03, s5 = m02 * m13 - m12 * m03;
  const Real c5 = m22 * m33 - m23 * m23, c4 = m12 * m33 - m13 * m23, c3 = m12 * m23 - m13 * m22;
  const Real c2 = m02 * m33 - m03 * m23, c1 = m02 * m23 - m03 * m22;
  return {m11 * c5 - m12 * c4 + m13 * c3, m02 * c4 - m01 * c5 - m03 * c3, m13 * s5 - m23 * s4 + m33 * s3,
          m22 * s4 - m12 * s5 - m23 * s3, m00 * c5 - m02 * c2 + m03 * c1, m23 * s2 - m03 * s5 - m33 * s1,
          m02 * s5 - m22 * s2 + m23 * s1, m03 * s4 - m13 * s2 + m33 * s0, m12 * s2 - m02 * s4 - m23 * s0,
          m02 * s3 - m12 * s1 + m22 * s0};
}

/// Smallest pivot of the LDL^T factorisation without interchanges: positive exactly if m is positive definite. After a
/// pivot that is not positive the others mean nothing, but the smallest stays not positive (or becomes not a number).
template <typename Real, typename Min>
inline Real smallest_pivot(const Symmetric4<Real>& m, const Min& min) {
  const Real i0 = Real(1) / m[0];
  const Real l1 = m[1] * i0, l2 = m[2] * i0, l3 = m[3] * i0;
  const Real d1 = m[4] - l1 * m[1];
  const Real e12 = m[5] - l1 * m[2], e13 = m[6] - l1 * m[3];
  const Real i1 = Real(1) / d1;
  const Real k2 = e12 * i1, k3 = e13 * i1;
  const Real d2 = (m[7] - l2 * m[2]) - k2 * e12;
  const Real e23 = (m[8] - l2 * m[3]) - k2 * e13;
  const Real d3 = ((m[9] - l3 * m[3]) - k3 * e13) - e23 * e23 / d2;
  return min(min(m[0], d1), min(d2, d3));
}

/// Coefficients of the characteristic quartic l^4 + c2 l^2 + c1 l + c0 of N(A): -2 |A|^2, -8 det A, |A|^4 - 4 |cof
/// A|^2.
template <typename Real>
struct Quartic {
  Real c2, c1, c0;
};

template <typename Real>
inline Quartic<Real> davenport_quartic(const Matrix9<Real>& A) {
  const Real k0 = A[4] * A[8] - A[5] * A[7], k1 = A[5] * A[6] - A[3] * A[8], k2 = A[3] * A[7] - A[4] * A[6];
  const Real k3 = A[2] * A[7] - A[1] * A[8], k4 = A[0] * A[8] - A[2] * A[6], k5 = A[1] * A[6] - A[0] * A[7];
  const Real k6 = A[1] * A[5] - A[2] * A[4], k7 = A[2] * A[3] - A[0] * A[5], k8 = A[0] * A[4] - A[1] * A[3];
  const Real norm = (A[0] * A[0] + A[1] * A[1] + A[2] * A[2]) + (A[3] * A[3] + A[4] * A[4] + A[5] * A[5]) +
                    (A[6] * A[6] + A[7] * A[7] + A[8] * A[8]);
  const Real cofactors = (k0 * k0 + k1 * k1 + k2 * k2) + (k3 * k3 + k4 * k4 + k5 * k5) + (k6 * k6 + k7 * k7 + k8 * k8);
  const Real determinant = A[0] * k0 + A[1] * k1 + A[2] * k2;
  return {Real(-2) * norm, Real(-8) * determinant, norm * norm - Real(4) * cofactors};
}

/// One Newton step towards the greatest root from above, where the quartic is convex: it never passes the root.
template <typename Real>
inline Real newton_step(const Quartic<Real>& p, const Real& x) {
  const Real square = x * x;
  const Real value = ((square + p.c2) * x + p.c1) * x + p.c0;
  const Real slope = (Real(4) * square + Real(2) * p.c2) * x + p.c1;
  return value / slope;
}

/// Relative sizes that the acceptance tests use, of matrices whose greatest entry is 1.
inline constexpr double kResidualTolerance = 5e-15;  ///< |N q - mu q|: some round-offs of N
inline constexpr double kEigenvalueTolerance =
    2e-14;                                         ///< mu counts as the greatest eigenvalue if none is above by more
inline constexpr double kSmallestAdjugate = 1e-6;  ///< below, adj(N - mu I) q is made of round-off or of a tie

}  // namespace softreel::detail
