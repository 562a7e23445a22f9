/// What the kernels of a step read of their StepSource and batches, in vector lanes; included by them only.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/elasticity/lane_elements.h"
#include "core/elasticity/step_terms.h"

namespace softreel::detail {

/// Dilatation stress as ElasticLaw has it, and its slope below the limit.
template <typename Lanes>
struct Pressure {
  Lanes value, slope;
  typename Lanes::mask_type at_limit;
};

template <typename Lanes, typename Flag>
[[gnu::always_inline]] inline Pressure<Lanes> find_pressure(const ElementBatch& batch, const Lanes& trace,
                                                            Flag aligned) {
  const Lanes lambda(batch.lambda, aligned), limit(batch.pressure_limit, aligned);
  Pressure<Lanes> pressure{lambda * trace, lambda, lambda * trace > limit};
  where(pressure.at_limit, pressure.value) = limit;
  return pressure;
}

template <typename Lanes>
[[gnu::always_inline]] inline Lanes trace(const Symmetric3<Lanes>& s) {
  return s[0] + s[3] + s[5];
}

/// sym(Q^T F) - I.
template <typename Lanes>
[[gnu::always_inline]] inline Symmetric3<Lanes> find_elastic_strain(const Matrix9<Lanes>& rotation,
                                                                    const Matrix9<Lanes>& F) {
  Symmetric3<Lanes> strain = symmetric_part(transposed_product(rotation, F));
  for (const std::size_t k : {0, 3, 5}) strain[k] -= Lanes(1);
  return strain;
}

/// b of the batch that starts at element `first`; past the end, the last one again.
template <typename Lanes>
[[gnu::always_inline]] inline Lanes find_damping(const StepSource& source, std::size_t first) {
  const std::size_t last = source.rotations.size() - 1;
  return Lanes([&](auto lane) { return source.damping_stiffness[std::min(first + lane, last)]; });
}

/// Tension limits of the batch that starts at element `first`, Pa; infinite without any.
template <typename Lanes, typename Flag>
[[gnu::always_inline]] inline Lanes find_least_tension(const StepSource& source, std::size_t first, Flag aligned) {
  if (source.tension_limits.empty()) return std::numeric_limits<double>::infinity();
  return Lanes(source.tension_limits.data() + first, aligned) *
         Lanes(1 / std::sqrt(source.seconds.velocity * source.seconds.position));
}

}  // namespace softreel::detail
