/// find_step_slab on lanes of doubles.
#include <algorithm>
#include <array>
#include <cmath>

#include <experimental/simd>

#include "core/elasticity/batch_tension.h"
#include "core/elasticity/lane_source.h"
#include "core/elasticity/short_vectors_simd.h"

namespace softreel {
namespace {

namespace stdx = std::experimental;
using Lanes = stdx::simd<double, stdx::simd_abi::deduce_t<double, kElementLanes>>;
using Floats = stdx::rebind_simd_t<float, Lanes>;
using Vector = detail::Vector3<Lanes>;
using Matrix = detail::Matrix9<Lanes>;
using Symmetric = detail::Symmetric3<Lanes>;

/// One element's (x y z r).
using Four = detail::FourDoubles;
using detail::FourFloats;
using detail::FourRows;

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

/// t sigma + t C : O + s C : D with D = Q^T grad v, O that of the offsets and C : D = 2 mu sym(D) + slope tr(D) I, in
/// the frame of the rest shape. O's slope lacks the share of elasticity that step_pressure_slope has.
struct Stress {
  Symmetric value;
  Lanes slope;         ///< step_pressure_slope
  bool tense = false;  ///< the positions may hold tension above the limit
};

/// Q^T G, symmetric part.
[[gnu::always_inline]] inline Symmetric find_strain(const Matrix& rotation, const Matrix& gradient) {
  return detail::symmetric_part(detail::transposed_product(rotation, gradient));
}

/// Lanes where a kappa_k may exceed `least`: by a bound on the sum of two principal strains that is sharp where two of
/// them are equal. None is below their mean by more than the root of two thirds of the sum of their deviators' squares.
[[gnu::always_inline]] inline Lanes::mask_type may_be_tense(const Symmetric& e, const Lanes& pressure,
                                                            const Lanes& two_mu, const Lanes& least) {
  const Lanes two(2), mean = detail::trace(e) * Lanes(1.0 / 3);
  const Lanes x = e[0] - mean, y = e[3] - mean, z = e[5] - mean;
  const Lanes square = (x * x + y * y + z * z) + two * (e[1] * e[1] + e[2] * e[2] + e[4] * e[4]);
  // (2 mu - least) (s_i + s_j) > 2 (2 mu - p) for s_i + s_j = 2 + 2 mean + sqrt(2 square / 3), without the root.
  const Lanes factor = two_mu - least, missing = two * ((two_mu - pressure) - factor * (mean + Lanes(1)));
  const auto reached = missing <= Lanes(0) || factor * factor * square >= Lanes(1.5) * (missing * missing);
  // Without a cap p may exceed 2 mu: then kappa is greatest where stretches are least.
  return (factor > Lanes(0) && reached) || pressure > two_mu;
}

/// kOffsets: there are offsets, whose gradient is `offset_gradient`. elastic: share of s that is not damping.
/// limit_share: 1 for the secant at the limit of the dilatation stress, 0 for the tangent. least: tension limit, Pa.
template <bool kOffsets>
[[gnu::always_inline]] inline Stress find_stress(const ElementBatch& batch, const Matrix& rotation, const Matrix& F,
                                                 const Matrix& velocity_gradient, const Matrix& offset_gradient,
                                                 const Lanes& seconds, const Lanes& share, const Lanes& elastic,
                                                 const Lanes& limit_share, const Lanes& least) {
  Symmetric strain = detail::find_elastic_strain(rotation, F);
  const Symmetric D = find_strain(rotation, velocity_gradient);
  const Lanes two_mu = load(batch.mu) + load(batch.mu);
  detail::Pressure<Lanes> pressure = detail::find_pressure(batch, detail::trace(strain), stdx::vector_aligned);
  const bool tense = stdx::any_of(may_be_tense(strain, pressure.value, two_mu, least));
  Lanes secant = pressure.slope, slope = pressure.slope;
  where(pressure.at_limit, secant) = limit_share * pressure.value / detail::trace(strain);
  where(pressure.at_limit, slope) = secant * elastic;
  if constexpr (kOffsets) {
    const Symmetric O = find_strain(rotation, offset_gradient);
    for (std::size_t k = 0; k < 6; ++k) strain[k] += O[k];
    pressure.value += secant * detail::trace(O);
  }
  const Lanes mean = seconds * pressure.value + share * (slope * detail::trace(D));
  const auto deviator = [&](std::size_t k) { return two_mu * (seconds * strain[k] + share * D[k]); };
  return {{mean + deviator(0), deviator(1), deviator(2), mean + deviator(3), deviator(4), mean + deviator(5)},
          slope,
          tense};
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

/// True if x y z of the vectors change by more than the root of `kept` of their length, or r by that much of 1 + r.
[[gnu::always_inline]] inline bool changes(const FourRows& from, const FourRows& to, float kept) {
  FourFloats change{}, size{};
  for (std::size_t k = 0; k < 4; ++k) {
    const FourFloats difference = to.rows[k] - from.rows[k];
    change += difference * difference;
    size += to.rows[k] * to.rows[k];
  }
  return !(change[0] + change[1] + change[2] <= kept * (size[0] + size[1] + size[2]) &&
           change[3] <= kept * (4 + size[3]));
}

/// Replaces the gradients of the batch's elements that change; true if there are any. gradients: of the first of them.
/// They start at a multiple of 16 bytes. kept: square of StepSource::kept_change; negative: all are replaced.
[[gnu::always_inline]] inline bool store_gradients(const NodeVectors& g, const Lanes& ratio, float kept,
                                                   float* gradients) {
  std::array<FourRows, kElementLanes> elements;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::array<Four, 4> rows = transposed(as_four(g[k][0]), as_four(g[k][1]), as_four(g[k][2]), as_four(ratio));
    for (std::size_t lane = 0; lane < kElementLanes; ++lane)
      elements[lane].rows[k] = __builtin_convertvector(rows[lane], FourFloats);
  }
  bool any = false;
  for (std::size_t lane = 0; lane < kElementLanes; ++lane) {
    auto& stored = *reinterpret_cast<FourRows*>(gradients + 16 * lane);
    if (kept >= 0 && !changes(stored, elements[lane], kept)) continue;
    stored = elements[lane];
    any = true;
  }
  return any;
}

/// A += Q [w]x, whose rows are those of Q times w, the moment of a batch.
[[gnu::always_inline]] inline void add_moment(const Matrix& Q, const BatchTension& tension, Matrix& A) {
  const Vector w = detail::load_vector<Lanes>(tension.moment, stdx::vector_aligned);
  for (std::size_t r = 0; r < 3; ++r) {
    const Lanes &x = Q[3 * r], &y = Q[3 * r + 1], &z = Q[3 * r + 2];
    A[3 * r] += y * w[2] - z * w[1];
    A[3 * r + 1] += z * w[0] - x * w[2];
    A[3 * r + 2] += x * w[1] - y * w[0];
  }
}

/// The curvatures of a slab's elements: no memory as long as there are none.
class StoredCurvatures {
 public:
  /// kept: as above, but of C itself, beside which the block of an element has a share of 1.
  StoredCurvatures(AlignedVector<float>& stored, std::size_t first_batch, float kept)
      : stored_(stored), first_batch_(first_batch), kept_(kept) {}

  /// Replaces those of the first `elements` lanes of batch b that change; true if there are any.
  bool store(std::size_t b, const BatchTension& tension, std::size_t elements) {
    if (stored_.empty()) stored_.resize(kSlabBatches * kElementLanes * kCurvatureFloats, 0.0F);
    bool any = false;
    for (std::size_t lane = 0; lane < elements; ++lane) {
      const auto entry = [&](std::size_t k) { return static_cast<float>(tension.curvature[k][lane]); };
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

/// Takes the forces of the first `elements` lanes off the slab's sums, in the order of elements. The sums start at a
/// multiple of 32 bytes.
[[gnu::always_inline]] inline void subtract_forces(const NodeVectors& f, std::size_t elements,
                                                   const std::uint16_t* places, double* sums) {
  std::array<std::array<Four, 4>, 4> rows;
  for (std::size_t k = 0; k < 4; ++k)
    rows[k] = transposed(as_four(f[k][0]), as_four(f[k][1]), as_four(f[k][2]), Four{});
  for (std::size_t lane = 0; lane < elements; ++lane)
    for (std::size_t k = 0; k < 4; ++k)
      *reinterpret_cast<detail::FourStoredDoubles*>(sums + std::size_t{4} * places[kElementLanes * k + lane]) -=
          rows[k][lane];
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
  const Lanes seconds(source.seconds.velocity), reach(source.seconds.position),
      limit_share(source.secant_at_limit ? 1.0 : 0.0);
  for (std::size_t b = begin; b < end; ++b) {
    const ElementBatch& batch = body.batches[b];
    const std::size_t first = kElementLanes * b;
    const Matrix Q = detail::rotation_matrix(detail::load_rotations<Lanes>(source.rotations, first));
    const Lanes damped_reach = reach + detail::find_damping<Lanes>(source, first), share = seconds * damped_reach;
    Lanes elastic = reach / damped_reach;
    where(damped_reach == Lanes(0), elastic) = Lanes(0);
    const Matrix F = detail::gradient<Lanes>(batch, source.positions, stdx::vector_aligned);
    const Matrix G = detail::gradient<Lanes>(batch, source.velocities, stdx::vector_aligned);
    Matrix offset_gradient{};
    if constexpr (kOffsets) offset_gradient = detail::gradient<Lanes>(batch, source.offsets, stdx::vector_aligned);
    const Stress stress = find_stress<kOffsets>(batch, Q, F, G, offset_gradient, seconds, share, elastic, limit_share,
                                                detail::find_least_tension<Lanes>(source, first, stdx::vector_aligned));
    const Lanes volume = load(batch.volume), mu = load(batch.mu), ratio = stress.slope / mu;
    Matrix T = detail::product(Q, stress.value), scaled = Q;
    const std::size_t count = std::min(kElementLanes, elements - first);
    if (stress.tense) {
      const BatchTension tension = find_batch_tension(source, batch, first);
      add_moment(Q, tension, T);
      changed |= curvatures.store(b, tension, count);
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
