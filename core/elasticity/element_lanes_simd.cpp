/// The kernels of element_lanes.h on lanes of doubles.
#include <algorithm>

#include <experimental/simd>

#include "core/elasticity/element_lanes.h"
#include "core/elasticity/element_rotation.h"
#include "core/elasticity/lane_elements.h"

namespace softreel {
namespace {

namespace stdx = std::experimental;
using Lanes = stdx::simd<double, stdx::simd_abi::deduce_t<double, kElementLanes>>;
using Mask = Lanes::mask_type;
using Vector = detail::Vector3<Lanes>;
using Matrix = detail::Matrix9<Lanes>;
using Symmetric = detail::Symmetric3<Lanes>;
using Quad = detail::Quad<Lanes>;

constexpr int kMostTurns = 6;
/// A turn of w leaves an error of some |w|^3: below this square, less than the unit round-off.
constexpr double kLastTurnSquare = 1e-11;
/// The matrix of the turn counts as positive definite if its determinant is this share of that of its mean diagonal:
/// far above round-off, and no tie is near.
constexpr double kSmallestDeterminant = 1e-3;

/// Lanes where the matrix of the turn is safely positive definite.
[[gnu::always_inline]] inline Mask is_definite(const detail::CofactorSolution<Lanes>& solution, const Lanes& trace) {
  const Lanes mean = trace * Lanes(2.0 / 3);  // of the diagonal of tr S I - S
  return trace > Lanes(0) && solution.minor1 > Lanes(0) && solution.minor2 > Lanes(0) &&
         solution.minor3 > Lanes(kSmallestDeterminant) * (mean * mean * mean);
}

/// Turns q to the nearest rotation of F; true where it is certified.
[[gnu::always_inline]] inline Mask find_nearest(const Matrix& F, Quad& q) {
  Mask good(false);
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const Matrix S = detail::transposed_product(detail::rotation_matrix(q), F);
    const Lanes trace = S[0] + S[4] + S[8];
    Symmetric H = detail::symmetric_part(S);
    for (Lanes& entry : H) entry = -entry;
    H[0] += trace;
    H[3] += trace;
    H[5] += trace;
    const auto solution = detail::solve_by_cofactors(H, Vector{S[7] - S[5], S[2] - S[6], S[3] - S[1]});
    const Vector& w = solution.v;
    const Lanes square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    const Mask definite = is_definite(solution, trace);
    const Lanes half(0.5);
    const Quad next =
        detail::turned(q, {half * w[0], half * w[1], half * w[2]}, [](const Lanes& x) { return stdx::sqrt(x); });
    for (std::size_t k = 0; k < 4; ++k) where(definite, q[k]) = next[k];
    good = definite && square < Lanes(kLastTurnSquare);
    if (stdx::all_of(good || !definite)) break;
  }
  return good;
}

/// How many of the first `count` lanes have det F below kFlatVolume.
[[gnu::always_inline]] inline std::int64_t count_flat(const Matrix& F, std::size_t count) {
  const Lanes volume =
      F[0] * (F[4] * F[8] - F[5] * F[7]) + F[1] * (F[5] * F[6] - F[3] * F[8]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
  const Mask flat = volume < Lanes(kFlatVolume);
  if (stdx::none_of(flat)) return 0;
  std::int64_t found = 0;
  for (std::size_t lane = 0; lane < count; ++lane) found += flat[lane] ? 1 : 0;
  return found;
}

Mat3 lane_of(const Matrix& F, std::size_t lane) {
  Mat3 A;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) A(r, c) = F[static_cast<std::size_t>(3 * r + c)][lane];
  return A;
}

}  // namespace

std::int64_t find_consistent_rotations(std::span<const ElementBatch> batches, std::span<const Vec3> positions,
                                       std::span<Quaternion> rotations, std::size_t begin, std::size_t end) {
  std::int64_t flat = 0;
  for (std::size_t b = begin; b < end; ++b) {
    const std::size_t first = kElementLanes * b, count = std::min(kElementLanes, rotations.size() - first);
    const Matrix F = detail::gradient<Lanes>(batches[b], positions, stdx::vector_aligned);
    flat += count_flat(F, count);
    Quad q = detail::load_rotations<Lanes>(rotations, first);
    const Mask good = find_nearest(F, q);
    alignas(32) double found[4][kElementLanes];
    for (std::size_t k = 0; k < 4; ++k) q[k].copy_to(found[k], stdx::vector_aligned);
    for (std::size_t lane = 0; lane < count; ++lane) {
      Quaternion& rotation = rotations[first + lane];
      rotation = good[lane] ? Quaternion(found[0][lane], found[1][lane], found[2][lane], found[3][lane])
                            : find_rotation(lane_of(F, lane), rotation);
    }
  }
  return flat;
}

}  // namespace softreel
