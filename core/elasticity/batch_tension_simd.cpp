/// find_batch_tension on lanes of doubles.
#include <array>

#include <experimental/simd>

#include "core/elasticity/batch_tension.h"
#include "core/elasticity/lane_source.h"

namespace softreel {
namespace {

namespace stdx = std::experimental;
using Lanes = stdx::simd<double, stdx::simd_abi::deduce_t<double, kElementLanes>>;
using Vector = detail::Vector3<Lanes>;
using Matrix = detail::Matrix9<Lanes>;
using Symmetric = detail::Symmetric3<Lanes>;

/// values[k] belongs to the unit vector axes[k]; these are orthonormal, in no particular order.
struct PrincipalAxes {
  Vector values;
  std::array<Vector, 3> axes;
};

/// One rotation of Jacobi's in the plane of rows p and q, r being the third: a_pq becomes zero.
void rotate_plane(Lanes& a_pp, Lanes& a_qq, Lanes& a_pq, Lanes& a_rp, Lanes& a_rq, Vector& v_p, Vector& v_q) {
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
PrincipalAxes find_principal_axes(Symmetric a) {
  constexpr int kSweeps = 4;
  constexpr double kRoundOff = 1e-32;  // square of that of the axes
  const Lanes zero(0), one(1);
  std::array<Vector, 3> v{Vector{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Lanes off = a[1] * a[1] + a[2] * a[2] + a[4] * a[4], all = a[0] * a[0] + a[3] * a[3] + a[5] * a[5];
    if (stdx::all_of(off <= Lanes(kRoundOff) * all)) break;
    rotate_plane(a[0], a[3], a[1], a[2], a[4], v[0], v[1]);
    rotate_plane(a[0], a[5], a[2], a[1], a[4], v[0], v[2]);
    rotate_plane(a[3], a[5], a[4], a[1], a[2], v[1], v[2]);
  }
  return {{a[0], a[3], a[5]}, v};
}

/// (kappa_k - least)^+ / 2 with their axes, in the frame of the rest shape.
PrincipalAxes find_tension(const Symmetric& strain, const Lanes& pressure, const Lanes& mu, const Lanes& least) {
  PrincipalAxes tension = find_principal_axes(strain);
  const Lanes two_mu = mu + mu, two(2);
  const Vector strains = tension.values;
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes stretches = two + (strains[(k + 1) % 3] + strains[(k + 2) % 3]);
    const Lanes kappa = two_mu - two * (two_mu - pressure) / stdx::max(stretches, Lanes(kSmallestStretchSum));
    tension.values[k] = Lanes(0.5) * (kappa - least);
    where(!(kappa > least), tension.values[k]) = Lanes(0);
  }
  return tension;
}

/// sum values[k] axes[k] axes[k]^T.
Symmetric matrix_of(const PrincipalAxes& tension) {
  Symmetric m{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector& v = tension.axes[k];
    const Vector scaled{tension.values[k] * v[0], tension.values[k] * v[1], tension.values[k] * v[2]};
    const Symmetric part{scaled[0] * v[0], scaled[0] * v[1], scaled[0] * v[2],
                         scaled[1] * v[1], scaled[1] * v[2], scaled[2] * v[2]};
    for (std::size_t c = 0; c < 6; ++c) m[c] += part[c];
  }
  return m;
}

/// sum_i b_i x u_i of L = sum_i u_i b_i^T: twice the turn of its antisymmetric part.
Vector curl(const Matrix& L) {
  return {L[7] - L[5], L[2] - L[6], L[3] - L[1]};
}

Vector product(const Symmetric& A, const Vector& v) {
  return {A[0] * v[0] + A[1] * v[1] + A[2] * v[2], A[1] * v[0] + A[3] * v[1] + A[4] * v[2],
          A[2] * v[0] + A[4] * v[1] + A[5] * v[2]};
}

/// t (r sum_i b_i x v_i + sum_i b_i x o_i) in the frame of the rest shape: twice the turn of the step, times t.
Vector find_way(const StepSource& source, const ElementBatch& batch, const Matrix& Q) {
  const auto curl_of = [&](std::span<const Vec3> vectors) {
    return curl(detail::transposed_product(Q, detail::gradient<Lanes>(batch, vectors, stdx::vector_aligned)));
  };
  Vector way = curl_of(source.velocities);
  for (Lanes& w : way) w *= Lanes(source.seconds.position);
  if (!source.offsets.empty()) {
    const Vector offset = curl_of(source.offsets);
    for (std::size_t c = 0; c < 3; ++c) way[c] += offset[c];
  }
  for (Lanes& w : way) w *= Lanes(source.seconds.velocity);
  return way;
}

}  // namespace

BatchTension find_batch_tension(const StepSource& source, const ElementBatch& batch, std::size_t first) {
  const Matrix Q = detail::rotation_matrix(detail::load_rotations<Lanes>(source.rotations, first));
  const Symmetric strain =
      detail::find_elastic_strain(Q, detail::gradient<Lanes>(batch, source.positions, stdx::vector_aligned));
  const Lanes mu(batch.mu, stdx::vector_aligned), reach(source.seconds.position);
  const Lanes pressure = detail::find_pressure(batch, detail::trace(strain), stdx::vector_aligned).value;
  PrincipalAxes tension =
      find_tension(strain, pressure, mu, detail::find_least_tension<Lanes>(source, first, stdx::vector_aligned));
  BatchTension result;
  const Vector moment = product(matrix_of(tension), find_way(source, batch, Q));
  for (std::size_t c = 0; c < 3; ++c) moment[c].copy_to(result.moment[c], stdx::vector_aligned);
  const Lanes share = reach / ((reach + detail::find_damping<Lanes>(source, first)) * mu);
  for (std::size_t k = 0; k < 3; ++k) {
    tension.values[k] *= share;
    tension.axes[k] = detail::product(Q, tension.axes[k]);
  }
  const Symmetric C = matrix_of(tension);
  for (std::size_t k = 0; k < 6; ++k) C[k].copy_to(result.curvature[k], stdx::vector_aligned);
  return result;
}

}  // namespace softreel
