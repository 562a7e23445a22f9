/// Twin of find_tension_curvatures in vector lanes; included by the kernel of a step only.
#pragma once

#include <utility>

#include <experimental/simd>

#include "core/elasticity/element.h"
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
  namespace stdx = std::experimental;
  const Lanes gap = a_qq - a_pp, off = a_pq + a_pq;
  // No division of zero by zero where the rows are done: the tangent is then 0 / tiny.
  const Lanes size = stdx::abs(gap) + stdx::sqrt(gap * gap + off * off) + Lanes(1e-150);
  Lanes tangent = off / size;
  where(gap < Lanes(0), tangent) = -tangent;
  const Lanes cosine = Lanes(1) / stdx::sqrt(Lanes(1) + tangent * tangent), sine = tangent * cosine;
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
[[gnu::always_inline]] inline PrincipalAxes<Lanes> find_principal_axes(Symmetric3<Lanes> a) {
  constexpr int kSweeps = 4;
  constexpr double kRoundOff = 1e-32;  // square of that of the axes
  const Lanes zero(0), one(1);
  std::array<Vector3<Lanes>, 3> v{Vector3<Lanes>{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Lanes off = a[1] * a[1] + a[2] * a[2] + a[4] * a[4], all = a[0] * a[0] + a[3] * a[3] + a[5] * a[5];
    if (std::experimental::all_of(off <= Lanes(kRoundOff) * all)) break;
    rotate_plane(a[0], a[3], a[1], a[2], a[4], v[0], v[1]);
    rotate_plane(a[0], a[5], a[2], a[1], a[4], v[0], v[2]);
    rotate_plane(a[3], a[5], a[4], a[1], a[2], v[1], v[2]);
  }
  return {{a[0], a[3], a[5]}, v};
}

/// What the tension of elements is found from, in the frame of the rest shape.
template <typename Lanes>
struct TensionSource {
  Symmetric3<Lanes> strain;
  Lanes pressure, mu, least;  ///< Pa
};

/// Lanes where a kappa_k may exceed `least`: by a bound on the sum of two principal strains that is sharp where two of
/// them are equal. None is below their mean by more than the root of two thirds of the sum of their deviators' squares.
template <typename Lanes>
[[gnu::always_inline]] inline auto may_be_tense(const TensionSource<Lanes>& source) {
  const Symmetric3<Lanes>& e = source.strain;
  const Lanes two_mu = source.mu + source.mu, two(2), mean = (e[0] + e[3] + e[5]) * Lanes(1.0 / 3);
  const Lanes x = e[0] - mean, y = e[3] - mean, z = e[5] - mean;
  const Lanes square = (x * x + y * y + z * z) + two * (e[1] * e[1] + e[2] * e[2] + e[4] * e[4]);
  // (2 mu - least) (s_i + s_j) > 2 (2 mu - p) for s_i + s_j = 2 + 2 mean + sqrt(2 square / 3), without the root.
  const Lanes factor = two_mu - source.least, missing = two * ((two_mu - source.pressure) - factor * (mean + Lanes(1)));
  const auto reached = missing <= Lanes(0) || factor * factor * square >= Lanes(1.5) * (missing * missing);
  // Without a cap p may exceed 2 mu: then kappa is greatest where stretches are least.
  return (factor > Lanes(0) && reached) || source.pressure > two_mu;
}

/// (kappa_k - least)^+ / 2 with their axes.
template <typename Lanes>
[[gnu::always_inline]] inline PrincipalAxes<Lanes> find_tension(const TensionSource<Lanes>& source) {
  PrincipalAxes<Lanes> tension = find_principal_axes(source.strain);
  const Lanes two_mu = source.mu + source.mu, two(2);
  const Vector3<Lanes> strains = tension.values;
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes stretches = two + (strains[(k + 1) % 3] + strains[(k + 2) % 3]);
    const Lanes kappa =
        two_mu - two * (two_mu - source.pressure) / std::experimental::max(stretches, Lanes(kSmallestStretchSum));
    tension.values[k] = Lanes(0.5) * (kappa - source.least);
    where(!(kappa > source.least), tension.values[k]) = Lanes(0);
  }
  return tension;
}

/// sum values[k] axes[k] axes[k]^T.
template <typename Lanes>
[[gnu::always_inline]] inline Symmetric3<Lanes> matrix_of(const PrincipalAxes<Lanes>& tension) {
  Symmetric3<Lanes> m{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3<Lanes>& v = tension.axes[k];
    const Vector3<Lanes> scaled{tension.values[k] * v[0], tension.values[k] * v[1], tension.values[k] * v[2]};
    const Symmetric3<Lanes> part{scaled[0] * v[0], scaled[0] * v[1], scaled[0] * v[2],
                                 scaled[1] * v[1], scaled[1] * v[2], scaled[2] * v[2]};
    for (std::size_t c = 0; c < 6; ++c) m[c] += part[c];
  }
  return m;
}

/// sum_i b_i x u_i of L = sum_i u_i b_i^T: twice the turn of its antisymmetric part.
template <typename Lanes>
[[gnu::always_inline]] inline Vector3<Lanes> curl(const Matrix9<Lanes>& L) {
  return {L[7] - L[5], L[2] - L[6], L[3] - L[1]};
}

template <typename Lanes>
[[gnu::always_inline]] inline Vector3<Lanes> product(const Symmetric3<Lanes>& A, const Vector3<Lanes>& v) {
  return {A[0] * v[0] + A[1] * v[1] + A[2] * v[2], A[1] * v[0] + A[3] * v[1] + A[4] * v[2],
          A[2] * v[0] + A[4] * v[1] + A[5] * v[2]};
}

/// A += Q [w]x, whose rows are those of Q times w.
template <typename Lanes>
[[gnu::always_inline]] inline void add_cross_product(const Matrix9<Lanes>& Q, const Vector3<Lanes>& w,
                                                     Matrix9<Lanes>& A) {
  for (std::size_t r = 0; r < 3; ++r) {
    const Lanes &x = Q[3 * r], &y = Q[3 * r + 1], &z = Q[3 * r + 2];
    A[3 * r] += y * w[2] - z * w[1];
    A[3 * r + 1] += z * w[0] - x * w[2];
    A[3 * r + 2] += x * w[1] - y * w[0];
  }
}

}  // namespace softreel::detail
