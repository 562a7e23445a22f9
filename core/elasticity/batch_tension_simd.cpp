/// find_batch_tension on lanes of doubles.
#include <experimental/simd>

#include "core/elasticity/batch_tension.h"
#include "core/elasticity/lane_source.h"
#include "core/elasticity/principal_axes.h"

namespace softreel {
namespace {

namespace stdx = std::experimental;
using Lanes = stdx::simd<double, stdx::simd_abi::deduce_t<double, kElementLanes>>;
using Vector = detail::Vector3<Lanes>;
using Matrix = detail::Matrix9<Lanes>;
using Symmetric = detail::Symmetric3<Lanes>;

using PrincipalAxes = detail::PrincipalAxes<Lanes>;

/// (kappa_k - least)^+ / 2 with their axes, in the frame of the rest shape.
PrincipalAxes find_tension(const Symmetric& strain, const Lanes& pressure, const Lanes& mu, const Lanes& least) {
  PrincipalAxes tension = detail::find_principal_axes(strain);
  const Lanes two_mu = mu + mu;
  const Vector strains = tension.values;
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes kappa = detail::find_kappa(strains[(k + 1) % 3], strains[(k + 2) % 3], pressure, two_mu);
    tension.values[k] = Lanes(0.5) * (kappa - least);
    where(!(kappa > least), tension.values[k]) = Lanes(0);
  }
  return tension;
}

/// Of the batch in a state, in the frame of the rest shape.
PrincipalAxes find_tension_in(std::span<const Vec3> positions, const Matrix& Q, const ElementBatch& batch,
                              const Lanes& least) {
  const Symmetric strain =
      detail::find_elastic_strain(Q, detail::gradient<Lanes>(batch, positions, stdx::vector_aligned));
  const Lanes pressure = detail::find_pressure(batch, detail::trace(strain), stdx::vector_aligned).value;
  return find_tension(strain, pressure, Lanes(batch.mu, stdx::vector_aligned), least);
}

Lanes greatest(const Vector& values) {
  return stdx::max(stdx::max(values[0], values[1]), values[2]);
}

/// That of the step's start, no greater than the one at the extrapolated place.
PrincipalAxes find_tension_at_start(const StepSource& source, const ElementBatch& batch, std::size_t first,
                                    const PrincipalAxes& there, const Lanes& least) {
  const Matrix Q = detail::rotation_matrix(detail::load_rotations<Lanes>(source.start_rotations, first));
  PrincipalAxes tension = find_tension_in(source.start_positions, Q, batch, least);
  const Lanes most = greatest(tension.values);
  Lanes share = greatest(there.values) / most;
  where(!(share < Lanes(1)), share) = Lanes(1);
  for (Lanes& value : tension.values) value *= share;
  return tension;
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
  const Lanes mu(batch.mu, stdx::vector_aligned), reach(source.seconds.position),
      least = detail::find_least_tension<Lanes>(source, first, stdx::vector_aligned);
  PrincipalAxes tension = find_tension_in(source.positions, Q, batch, least);
  if (!source.start_positions.empty()) tension = find_tension_at_start(source, batch, first, tension, least);
  BatchTension result;
  const Vector moment = product(detail::matrix_of(tension), find_way(source, batch, Q));
  for (std::size_t c = 0; c < 3; ++c) moment[c].copy_to(result.moment[c], stdx::vector_aligned);
  const Lanes share = reach / ((reach + detail::find_damping<Lanes>(source, first)) * mu);
  for (std::size_t k = 0; k < 3; ++k) {
    tension.values[k] *= share;
    tension.axes[k] = detail::product(Q, tension.axes[k]);
  }
  const Symmetric C = detail::matrix_of(tension);
  for (std::size_t k = 0; k < 6; ++k) C[k].copy_to(result.curvature[k], stdx::vector_aligned);
  return result;
}

}  // namespace softreel
