/// Principal axes of symmetric 3x3 matrices in vector lanes; included by kernels only.
#pragma once

#include <array>

#include "core/elasticity/lane_algebra.h"

namespace softreel::detail {

/// values[k] belongs to the unit vector axes[k]; these are orthonormal, in no particular order.
template <typename Lanes>
struct PrincipalAxes {
  Vector3<Lanes> values;
  std::array<Vector3<Lanes>, 3> axes;
};

/// One rotation of Jacobi's in the plane of rows p and q, r being the third: a_pq becomes zero.
template <typename Lanes>
[[gnu::always_inline]] inline void rotate_plane(Lanes& a_pp, Lanes& a_qq, Lanes& a_pq, Lanes& a_rp, Lanes& a_rq,
                                                Vector3<Lanes>& v_p, Vector3<Lanes>& v_q) {
  const Lanes gap = a_qq - a_pp, off = a_pq + a_pq;
  // No division of zero by zero where the rows are done: the tangent is then 0 / tiny.
  const Lanes size = abs(gap) + sqrt(gap * gap + off * off) + Lanes(1e-150);
  Lanes tangent = off / size;
  where(gap < Lanes(0), tangent) = -tangent;
  const Lanes cosine = Lanes(1) / sqrt(Lanes(1) + tangent * tangent), sine = tangent * cosine;
  a_pp -= tangent * a_pq;
  a_qq += tangent * a_pq;
  a_pq = Lanes(0);
  const auto turn = [&](Lanes& p, Lanes& q) {
    const Lanes turned_p = cosine * p - sine * q;
    q = sine * p + cosine * q;
    p = turned_p;
  };
  turn(a_rp, a_rq);
  for (std::size_t c = 0; c < 3; ++c) turn(v_p[c], v_q[c]);
}

/// By cyclic Jacobi rotations: right for every input, to round-off of the greatest entry.
template <typename Lanes>
PrincipalAxes<Lanes> find_principal_axes(Symmetric3<Lanes> a) {
  constexpr int kSweeps = 4;
  constexpr double kRoundOff = 1e-32;  // square of that of the axes
  const Lanes zero(0), one(1);
  std::array<Vector3<Lanes>, 3> v{Vector3<Lanes>{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Lanes off = a[1] * a[1] + a[2] * a[2] + a[4] * a[4], all = a[0] * a[0] + a[3] * a[3] + a[5] * a[5];
    if (all_of(off <= Lanes(kRoundOff) * all)) break;
    rotate_plane(a[0], a[3], a[1], a[2], a[4], v[0], v[1]);
    rotate_plane(a[0], a[5], a[2], a[1], a[4], v[0], v[2]);
    rotate_plane(a[3], a[5], a[4], a[1], a[2], v[1], v[2]);
  }
  return {{a[0], a[3], a[5]}, v};
}

/// sum values[k] axes[k] axes[k]^T.
template <typename Lanes>
Symmetric3<Lanes> matrix_of(const PrincipalAxes<Lanes>& principal) {
  Symmetric3<Lanes> m{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3<Lanes>& v = principal.axes[k];
    const Lanes& value = principal.values[k];
    const Vector3<Lanes> scaled{value * v[0], value * v[1], value * v[2]};
    const Symmetric3<Lanes> part{scaled[0] * v[0], scaled[0] * v[1], scaled[0] * v[2],
                                 scaled[1] * v[1], scaled[1] * v[2], scaled[2] * v[2]};
    for (std::size_t c = 0; c < 6; ++c) m[c] += part[c];
  }
  return m;
}

/// kappa_k of rotation_curvature for principal strains in the other two axes, Pa.
template <typename Lanes>
Lanes find_kappa(const Lanes& strain_i, const Lanes& strain_j, const Lanes& pressure, const Lanes& two_mu) {
  const Lanes stretches = Lanes(2) + (strain_i + strain_j);
  return two_mu - Lanes(2) * (two_mu - pressure) / max(stretches, Lanes(kSmallestStretchSum));
}

}  // namespace softreel::detail
