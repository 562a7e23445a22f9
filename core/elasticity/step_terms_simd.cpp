/// find_step_batches on lanes of doubles.
#include <algorithm>

#include <experimental/simd>

#include "core/elasticity/lane_elements.h"
#include "core/elasticity/step_terms.h"

namespace softreel {
namespace {

namespace stdx = std::experimental;
using Lanes = stdx::simd<double, stdx::simd_abi::deduce_t<double, kElementLanes>>;
using Vector = detail::Vector3<Lanes>;
using Matrix = detail::Matrix9<Lanes>;
using Symmetric = detail::Symmetric3<Lanes>;

/// Lanes of a batch on their way to arrays of elements.
template <std::size_t kRows>
struct alignas(32) LaneRows {
  double rows[kRows][kElementLanes];
  [[gnu::always_inline]] void put(std::size_t row, const Lanes& lanes) {
    lanes.copy_to(rows[row], stdx::vector_aligned);
  }
};

Lanes load(const double* from) {
  return Lanes(from, stdx::vector_aligned);
}

/// Dilatation stress and its slope, as ElasticLaw has them.
struct Pressure {
  Lanes value, slope;
};

[[gnu::always_inline]] inline Pressure find_pressure(const ElementBatch& batch, const Lanes& trace) {
  const Lanes lambda = load(batch.lambda), limit = load(batch.pressure_limit);
  Pressure pressure{lambda * trace, lambda};
  where(pressure.value > limit, pressure.slope) = Lanes(0);
  where(pressure.value > limit, pressure.value) = limit;
  return pressure;
}

/// t sigma + t C : O + s C : D with D = Q^T grad v, O that of the offsets and C : D = 2 mu sym(D) + slope tr(D) I, in
/// the frame of the rest shape.
struct Stress {
  Symmetric value;
  Lanes slope;
};

[[gnu::always_inline]] inline Lanes trace(const Symmetric& s) {
  return s[0] + s[3] + s[5];
}

/// Q^T G, symmetric part.
[[gnu::always_inline]] inline Symmetric find_strain(const Matrix& rotation, const Matrix& gradient) {
  return detail::symmetric_part(detail::transposed_product(rotation, gradient));
}

/// kOffsets: there are offsets, whose gradient is `offset_gradient`.
template <bool kOffsets>
[[gnu::always_inline]] inline Stress find_stress(const ElementBatch& batch, const Matrix& rotation, const Matrix& F,
                                                 const Matrix& velocity_gradient, const Matrix& offset_gradient,
                                                 const Lanes& seconds, const Lanes& share) {
  Symmetric strain = find_strain(rotation, F);
  const Symmetric D = find_strain(rotation, velocity_gradient);
  const Lanes one(1), two_mu = load(batch.mu) + load(batch.mu);
  for (const std::size_t k : {0, 3, 5}) strain[k] -= one;
  Pressure pressure = find_pressure(batch, trace(strain));
  if constexpr (kOffsets) {
    const Symmetric O = find_strain(rotation, offset_gradient);
    for (std::size_t k = 0; k < 6; ++k) strain[k] += O[k];
    pressure.value += pressure.slope * trace(O);
  }
  const Lanes mean = seconds * pressure.value + share * (pressure.slope * trace(D));
  const auto deviator = [&](std::size_t k) { return two_mu * (seconds * strain[k] + share * D[k]); };
  return {{mean + deviator(0), deviator(1), deviator(2), mean + deviator(3), deviator(4), mean + deviator(5)},
          pressure.slope};
}

/// Rows 3 k + c: component c of -T b_k; those of node 0 make the sum zero.
[[gnu::always_inline]] inline void put_forces(const ElementBatch& batch, const Matrix& T, LaneRows<12>& forces) {
  Vector sum{Lanes(0), Lanes(0), Lanes(0)};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector f = detail::product(T, detail::load_vector<Lanes>(batch.gradients + 3 * k, stdx::vector_aligned));
    for (std::size_t c = 0; c < 3; ++c) {
      forces.put(3 * k + 3 + c, -f[c]);
      sum[c] += f[c];
    }
  }
  for (std::size_t c = 0; c < 3; ++c) forces.put(c, sum[c]);
}

/// Rows 3 k + c: component c of scale Q b_k.
[[gnu::always_inline]] inline void put_gradients(const ElementBatch& batch, const Matrix& scaled_rotation,
                                                 LaneRows<12>& gradients) {
  Vector sum{Lanes(0), Lanes(0), Lanes(0)};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector g =
        detail::product(scaled_rotation, detail::load_vector<Lanes>(batch.gradients + 3 * k, stdx::vector_aligned));
    for (std::size_t c = 0; c < 3; ++c) {
      gradients.put(3 * k + 3 + c, g[c]);
      sum[c] -= g[c];
    }
  }
  for (std::size_t c = 0; c < 3; ++c) gradients.put(c, sum[c]);
}

/// Rows to elements: gradients as x y z r.
[[gnu::always_inline]] inline void store(const LaneRows<12>& gradients, const LaneRows<12>& forces, const Lanes& ratio,
                                         std::size_t first, StepTerms& terms) {
  for (std::size_t lane = 0; lane < kElementLanes; ++lane) {
    float* const to = terms.gradients.data() + 16 * (first + lane);
    const auto r = static_cast<float>(ratio[lane]);
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t c = 0; c < 3; ++c) to[4 * k + c] = static_cast<float>(gradients.rows[3 * k + c][lane]);
      to[4 * k + 3] = r;
    }
    double* const force = terms.forces.data() + 12 * (first + lane);
    for (std::size_t c = 0; c < 12; ++c) force[c] = forces.rows[c][lane];
  }
}

/// kOffsets: there are offsets.
template <bool kOffsets>
std::int64_t find_batches(std::span<const ElementBatch> batches, const StepSource& source, float expected_ratio,
                          StepTerms& terms, std::size_t begin, std::size_t end) {
  std::int64_t different = 0;
  const Lanes seconds(source.seconds.velocity), reach(source.seconds.position);
  for (std::size_t b = begin; b < end; ++b) {
    const ElementBatch& batch = batches[b];
    const std::size_t first = kElementLanes * b, last = source.rotations.size() - 1;
    const Matrix Q = detail::rotation_matrix(detail::load_rotations<Lanes>(source.rotations, first));
    const Lanes share =
        seconds * (reach + Lanes([&](auto lane) { return source.damping_stiffness[std::min(first + lane, last)]; }));
    const Matrix F = detail::gradient<Lanes>(batch, source.positions, stdx::vector_aligned);
    const Matrix G = detail::gradient<Lanes>(batch, source.velocities, stdx::vector_aligned);
    Matrix offset_gradient{};
    if constexpr (kOffsets) offset_gradient = detail::gradient<Lanes>(batch, source.offsets, stdx::vector_aligned);
    const Stress stress = find_stress<kOffsets>(batch, Q, F, G, offset_gradient, seconds, share);
    const Lanes volume = load(batch.volume), mu = load(batch.mu), ratio = stress.slope / mu;
    Matrix T = detail::product(Q, stress.value), scaled = Q;
    const Lanes scale = stdx::sqrt(share * volume * mu);
    for (std::size_t k = 0; k < 9; ++k) {
      T[k] *= volume;
      scaled[k] *= scale;
    }
    LaneRows<12> gradients, forces;
    put_gradients(batch, scaled, gradients);
    put_forces(batch, T, forces);
    store(gradients, forces, ratio, first, terms);
    for (std::size_t lane = 0; lane < kElementLanes; ++lane)
      if (static_cast<float>(ratio[lane]) != expected_ratio) ++different;
  }
  return different;
}

}  // namespace

std::int64_t find_step_batches(std::span<const ElementBatch> batches, const StepSource& source, float expected_ratio,
                               StepTerms& terms, std::size_t begin, std::size_t end) {
  return source.offsets.empty() ? find_batches<false>(batches, source, expected_ratio, terms, begin, end)
                                : find_batches<true>(batches, source, expected_ratio, terms, begin, end);
}

}  // namespace softreel
