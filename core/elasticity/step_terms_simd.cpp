/// find_step_slab on lanes of doubles.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <experimental/simd>

#include "core/elasticity/lane_elements.h"
#include "core/elasticity/lane_tension.h"
#include "core/elasticity/step_terms.h"

namespace softreel {
namespace {

namespace stdx = std::experimental;
using Lanes = stdx::simd<double, stdx::simd_abi::deduce_t<double, kElementLanes>>;
using Floats = stdx::rebind_simd_t<float, Lanes>;
using Vector = detail::Vector3<Lanes>;
using Matrix = detail::Matrix9<Lanes>;
using Symmetric = detail::Symmetric3<Lanes>;

/// Lanes of one element's (x y z r), for the shuffles that std::experimental::simd does not have.
typedef double Four __attribute__((vector_size(32)));
typedef float FourFloats __attribute__((vector_size(16)));

/// Four quantities of four elements each, as four elements' four quantities.
[[gnu::always_inline]] inline std::array<Four, 4> transposed(const Four& a, const Four& b, const Four& c,
                                                             const Four& d) {
  const Four even_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), odd_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7),
             even_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6), odd_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return {__builtin_shufflevector(even_ab, even_cd, 0, 1, 4, 5), __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 4, 5),
          __builtin_shufflevector(even_ab, even_cd, 2, 3, 6, 7), __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 6, 7)};
}

[[gnu::always_inline]] inline Four as_four(const Lanes& lanes) {
  static_assert(kElementLanes == 4);
  return reinterpret_cast<Four>(static_cast<__m256d>(lanes));
}

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
  bool tense = false;  ///< the positions may hold tension above the limit
};

[[gnu::always_inline]] inline Lanes trace(const Symmetric& s) {
  return s[0] + s[3] + s[5];
}

/// Q^T G, symmetric part.
[[gnu::always_inline]] inline Symmetric find_strain(const Matrix& rotation, const Matrix& gradient) {
  return detail::symmetric_part(detail::transposed_product(rotation, gradient));
}

[[gnu::always_inline]] inline Symmetric find_elastic_strain(const Matrix& rotation, const Matrix& F) {
  Symmetric strain = find_strain(rotation, F);
  for (const std::size_t k : {0, 3, 5}) strain[k] -= Lanes(1);
  return strain;
}

/// kOffsets: there are offsets, whose gradient is `offset_gradient`. least: tension limit, Pa.
template <bool kOffsets>
[[gnu::always_inline]] inline Stress find_stress(const ElementBatch& batch, const Matrix& rotation, const Matrix& F,
                                                 const Matrix& velocity_gradient, const Matrix& offset_gradient,
                                                 const Lanes& seconds, const Lanes& share, const Lanes& least) {
  Symmetric strain = find_elastic_strain(rotation, F);
  const Symmetric D = find_strain(rotation, velocity_gradient);
  const Lanes mu = load(batch.mu), two_mu = mu + mu;
  Pressure pressure = find_pressure(batch, trace(strain));
  const bool tense =
      stdx::any_of(detail::may_be_tense(detail::TensionSource<Lanes>{strain, pressure.value, mu, least}));
  if constexpr (kOffsets) {
    const Symmetric O = find_strain(rotation, offset_gradient);
    for (std::size_t k = 0; k < 6; ++k) strain[k] += O[k];
    pressure.value += pressure.slope * trace(O);
  }
  const Lanes mean = seconds * pressure.value + share * (pressure.slope * trace(D));
  const auto deviator = [&](std::size_t k) { return two_mu * (seconds * strain[k] + share * D[k]); };
  return {{mean + deviator(0), deviator(1), deviator(2), mean + deviator(3), deviator(4), mean + deviator(5)},
          pressure.slope,
          tense};
}

[[gnu::always_inline]] inline Lanes find_damping(const StepSource& source, std::size_t first) {
  const std::size_t last = source.rotations.size() - 1;
  return Lanes([&](auto lane) { return source.damping_stiffness[std::min(first + lane, last)]; });
}

/// Tension limits of the batch that starts at element `first`, Pa; infinite without any.
[[gnu::always_inline]] inline Lanes find_least_tension(const StepSource& source, std::size_t first) {
  if (source.tension_limits.empty()) return std::numeric_limits<double>::infinity();
  return load(source.tension_limits.data() + first) *
         Lanes(1 / std::sqrt(source.seconds.velocity * source.seconds.position));
}

/// What tension above the limit adds to a batch: to the stress by its nodes' motion, and to the matrix.
struct Curvature {
  Vector moment;  ///< w, with which the stress in the frame of the rest shape gains [w]x
  Symmetric C;    ///< in space, over the share of the gradients
};

/// Apart from the kernel, and from memory again, so that batches without tension keep what they have in registers.
[[gnu::noinline]] Curvature find_curvature(const StepSource& source, const ElementBatch& batch, std::size_t first) {
  const Matrix Q = detail::rotation_matrix(detail::load_rotations<Lanes>(source.rotations, first));
  const Symmetric strain =
      find_elastic_strain(Q, detail::gradient<Lanes>(batch, source.positions, stdx::vector_aligned));
  const Lanes mu = load(batch.mu), reach(source.seconds.position);
  detail::PrincipalAxes<Lanes> tension = detail::find_tension(detail::TensionSource<Lanes>{
      strain, find_pressure(batch, trace(strain)).value, mu, find_least_tension(source, first)});
  const auto curl_of = [&](std::span<const Vec3> vectors) {
    return detail::curl(detail::transposed_product(Q, detail::gradient<Lanes>(batch, vectors, stdx::vector_aligned)));
  };
  Vector way = curl_of(source.velocities);
  for (Lanes& w : way) w *= reach;
  if (!source.offsets.empty()) {
    const Vector offset = curl_of(source.offsets);
    for (std::size_t c = 0; c < 3; ++c) way[c] += offset[c];
  }
  for (Lanes& w : way) w *= Lanes(source.seconds.velocity);
  Curvature curvature{detail::product(detail::matrix_of(tension), way), {}};
  const Lanes share = reach / ((reach + find_damping(source, first)) * mu);
  for (std::size_t k = 0; k < 3; ++k) {
    tension.values[k] *= share;
    tension.axes[k] = detail::product(Q, tension.axes[k]);
  }
  curvature.C = detail::matrix_of(tension);
  return curvature;
}

using NodeVectors = std::array<Vector, 4>;

/// matrix * b_k for the four nodes of the elements; that of node 0 makes the sum zero.
[[gnu::always_inline]] inline NodeVectors find_products(const ElementBatch& batch, const Matrix& matrix) {
  NodeVectors products;
  for (std::size_t k = 0; k < 3; ++k)
    products[k + 1] =
        detail::product(matrix, detail::load_vector<Lanes>(batch.gradients + 3 * k, stdx::vector_aligned));
  for (std::size_t c = 0; c < 3; ++c) products[0][c] = -(products[1][c] + products[2][c] + products[3][c]);
  return products;
}

/// True if x y z of the vectors change by more than the root of `kept` of their length, or r by anything.
[[gnu::always_inline]] inline bool changes(const std::array<FourFloats, 4>& from, const std::array<FourFloats, 4>& to,
                                           float kept) {
  FourFloats change{}, size{};
  for (std::size_t k = 0; k < 4; ++k) {
    const FourFloats difference = to[k] - from[k];
    change += difference * difference;
    size += to[k] * to[k];
  }
  return !(change[0] + change[1] + change[2] <= kept * (size[0] + size[1] + size[2]) && change[3] == 0);
}

/// Replaces the gradients of the batch's elements that change; true if there are any. gradients: of the first of them.
/// kept: square of StepSource::kept_change; negative: all are replaced.
[[gnu::always_inline]] inline bool store_gradients(const NodeVectors& g, const Lanes& ratio, float kept,
                                                   float* gradients) {
  std::array<std::array<FourFloats, 4>, kElementLanes> elements;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::array<Four, 4> rows = transposed(as_four(g[k][0]), as_four(g[k][1]), as_four(g[k][2]), as_four(ratio));
    for (std::size_t lane = 0; lane < kElementLanes; ++lane)
      elements[lane][k] = __builtin_convertvector(rows[lane], FourFloats);
  }
  bool any = false;
  for (std::size_t lane = 0; lane < kElementLanes; ++lane) {
    auto& stored = *reinterpret_cast<std::array<FourFloats, 4>*>(gradients + 16 * lane);
    if (kept >= 0 && !changes(stored, elements[lane], kept)) continue;
    stored = elements[lane];
    any = true;
  }
  return any;
}

/// The curvatures of a slab's elements: no memory as long as there are none.
class StoredCurvatures {
 public:
  /// kept: as above, but of C itself, beside which the block of an element has a share of 1.
  StoredCurvatures(AlignedVector<float>& stored, std::size_t first_batch, float kept)
      : stored_(stored), first_batch_(first_batch), kept_(kept) {}

  /// Replaces those of the first `elements` lanes of batch b that change; true if there are any.
  bool store(std::size_t b, const Symmetric& C, std::size_t elements) {
    if (stored_.empty()) stored_.resize(kSlabBatches * kElementLanes * kCurvatureFloats, 0.0F);
    bool any = false;
    alignas(32) double entries[6][kElementLanes];
    for (std::size_t k = 0; k < 6; ++k) C[k].copy_to(entries[k], stdx::vector_aligned);
    for (std::size_t lane = 0; lane < elements; ++lane) {
      const auto entry = [&](std::size_t k) { return static_cast<float>(entries[k][lane]); };
      any |=
          replace({entry(0), entry(1), entry(2), 0, entry(1), entry(3), entry(4), 0, entry(2), entry(4), entry(5), 0},
                  rows(b, lane));
    }
    return any;
  }

  /// The same for elements without tension.
  bool clear(std::size_t b, std::size_t elements) {
    if (stored_.empty()) return false;
    bool any = false;
    for (std::size_t lane = 0; lane < elements; ++lane) any |= replace({}, rows(b, lane));
    return any;
  }

  /// After the last batch: gives the memory back if no element has any.
  void finish() {
    if (!nonzero_) AlignedVector<float>().swap(stored_);
  }

 private:
  using Entries = std::array<float, kCurvatureFloats>;

  float* rows(std::size_t b, std::size_t lane) {
    return stored_.data() + kCurvatureFloats * (kElementLanes * (b - first_batch_) + lane);
  }

  bool replace(const Entries& fresh, float* rows) {
    float change = 0;
    for (std::size_t k = 0; k < kCurvatureFloats; ++k) change += (fresh[k] - rows[k]) * (fresh[k] - rows[k]);
    const bool changes = change > 0 && !(change <= kept_);
    if (changes) std::copy(fresh.begin(), fresh.end(), rows);
    nonzero_ = nonzero_ || rows[0] + rows[5] + rows[10] > 0;
    return changes;
  }

  AlignedVector<float>& stored_;
  std::size_t first_batch_;
  float kept_;
  bool nonzero_ = false;
};

/// Takes the forces of the first `elements` lanes off the slab's sums, in the order of elements.
[[gnu::always_inline]] inline void subtract_forces(const NodeVectors& f, std::size_t elements,
                                                   const std::uint16_t* places, double* sums) {
  std::array<std::array<Four, 4>, 4> rows;
  for (std::size_t k = 0; k < 4; ++k)
    rows[k] = transposed(as_four(f[k][0]), as_four(f[k][1]), as_four(f[k][2]), Four{});
  for (std::size_t lane = 0; lane < elements; ++lane)
    for (std::size_t k = 0; k < 4; ++k)
      *reinterpret_cast<Four*>(sums + std::size_t{4} * places[kElementLanes * k + lane]) -= rows[k][lane];
}

/// kOffsets: there are offsets.
template <bool kOffsets>
std::int64_t find_slab(const ElasticBody& body, const StepSource& source, float expected_ratio, StepTerms& terms,
                       std::size_t slab) {
  std::int64_t different = 0;
  const std::size_t elements = source.rotations.size(), begin = kSlabBatches * slab,
                    end = std::min(begin + kSlabBatches, body.batches.size());
  const NodeSlabs& slabs = body.node_slabs;
  double* const sums = terms.forces.data() + std::size_t{4} * slabs.slab_offsets[slab];
  std::fill(sums, terms.forces.data() + std::size_t{4} * slabs.slab_offsets[slab + 1], 0.0);
  const auto kept = static_cast<float>(source.kept_change * std::abs(source.kept_change));
  bool changed = false;
  StoredCurvatures curvatures(terms.curvatures[slab], begin, kept);
  const Lanes seconds(source.seconds.velocity), reach(source.seconds.position);
  for (std::size_t b = begin; b < end; ++b) {
    const ElementBatch& batch = body.batches[b];
    const std::size_t first = kElementLanes * b;
    const Matrix Q = detail::rotation_matrix(detail::load_rotations<Lanes>(source.rotations, first));
    const Lanes share = seconds * (reach + find_damping(source, first));
    const Matrix F = detail::gradient<Lanes>(batch, source.positions, stdx::vector_aligned);
    const Matrix G = detail::gradient<Lanes>(batch, source.velocities, stdx::vector_aligned);
    Matrix offset_gradient{};
    if constexpr (kOffsets) offset_gradient = detail::gradient<Lanes>(batch, source.offsets, stdx::vector_aligned);
    const Stress stress =
        find_stress<kOffsets>(batch, Q, F, G, offset_gradient, seconds, share, find_least_tension(source, first));
    const Lanes volume = load(batch.volume), mu = load(batch.mu), ratio = stress.slope / mu;
    Matrix T = detail::product(Q, stress.value), scaled = Q;
    const std::size_t count = std::min(kElementLanes, elements - first);
    if (stress.tense) {
      const Curvature curvature = find_curvature(source, batch, first);
      detail::add_cross_product(Q, curvature.moment, T);
      changed |= curvatures.store(b, curvature.C, count);
    } else {
      changed |= curvatures.clear(b, count);
    }
    const Lanes scale = stdx::sqrt(share * volume * mu);
    for (std::size_t k = 0; k < 9; ++k) {
      T[k] *= volume;
      scaled[k] *= scale;
    }
    changed |= store_gradients(find_products(batch, scaled), ratio, kept, terms.gradients.data() + 16 * first);
    subtract_forces(find_products(batch, T), count, slabs.places_of(b), sums);
    different += stdx::popcount(stdx::static_simd_cast<Floats>(ratio) != Floats(expected_ratio));
  }
  curvatures.finish();
  if (changed) terms.changed[slab] = 1;
  return different;
}

}  // namespace

std::int64_t find_step_slab(const ElasticBody& body, const StepSource& source, float expected_ratio, StepTerms& terms,
                            std::size_t slab) {
  return source.offsets.empty() ? find_slab<false>(body, source, expected_ratio, terms, slab)
                                : find_slab<true>(body, source, expected_ratio, terms, slab);
}

}  // namespace softreel
