/// The batched twin of find_rotation: the quartic's root, the adjugate and its certificate on lanes of doubles.
///
/// In lanes the quartic comes first, not the warm start: its Newton needs one division a step and no branch, and with
/// the root known one adjugate times the guess gives the eigenvector, where Rayleigh quotients take three.
#include <cmath>

#include <experimental/simd>

#include "core/elasticity/davenport.h"
#include "core/elasticity/element_rotation.h"

namespace softreel {
namespace {

using detail::adjugate;
using detail::dot;
using detail::multiply;
using detail::newton_step;
using detail::scaled;
using detail::shifted;
using detail::smallest_pivot;

namespace stdx = std::experimental;
using Lanes = stdx::fixed_size_simd<double, kRotationLanes>;
using Mask = Lanes::mask_type;

constexpr int kNewtonSteps = 12;  ///< mild deformations need 3, any simple root at most 10

/// Greatest absolute entry of each lane; at least the smallest normal number, so that dividing by it is safe.
Lanes greatest_entry(const detail::Matrix9<Lanes>& A) {
  Lanes greatest(1e-300);
  for (const Lanes& entry : A) greatest = stdx::max(greatest, stdx::abs(entry));
  return greatest;
}

/// An upper bound of the greatest root: sqrt(3) |A|, or closer, one Newton step from the guess's Rayleigh quotient.
///
/// Such a step ends above the root if it starts right of the greatest critical point, where the quartic is convex; that
/// is so where the point is positive with positive first and second derivative.
Lanes upper_bound(const detail::Quartic<Lanes>& quartic, const Lanes& rayleigh) {
  const Lanes bound = stdx::sqrt(Lanes(-1.5) * quartic.c2), square = rayleigh * rayleigh;
  const Lanes slope = (Lanes(4) * square + Lanes(2) * quartic.c2) * rayleigh + quartic.c1;
  const Mask convex =
      rayleigh > Lanes(0) && Lanes(6) * square + quartic.c2 > Lanes(0) && slope > Lanes(1e-3) * square * rayleigh;
  Lanes start = bound;
  where(convex, start) = stdx::min(bound, rayleigh - newton_step(quartic, rayleigh));
  return start;
}

Lanes greatest_root(const detail::Matrix9<Lanes>& A, const Lanes& rayleigh) {
  const detail::Quartic<Lanes> quartic = detail::davenport_quartic(A);
  Lanes root = upper_bound(quartic, rayleigh);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Lanes change = newton_step(quartic, root);
    const Mask moves = change > Lanes(1e-16) * root;
    where(moves, root) = root - change;
    // A step below 1e-9 leaves the next one, quadratically smaller, below round-off.
    if (stdx::none_of(change > Lanes(1e-9) * root)) break;
  }
  return root;
}

/// Unit eigenvector nearest to the guess, if the lane's `good` stays true.
detail::Quad<Lanes> eigenvector(const detail::Symmetric4<Lanes>& N, const Lanes& root, const detail::Quad<Lanes>& guess,
                                Mask& good) {
  const detail::Quad<Lanes> v = multiply(adjugate(shifted(N, root)), guess);
  const Lanes length = stdx::sqrt(dot(v, v));
  good = good && length > Lanes(detail::kSmallestAdjugate);
  return scaled(v, Lanes(1) / stdx::max(length, Lanes(1e-300)));
}

/// Lanes whose v is an eigenvector of the greatest eigenvalue.
Mask certified(const detail::Symmetric4<Lanes>& N, const detail::Quad<Lanes>& v) {
  const detail::Quad<Lanes> product = multiply(N, v);
  const Lanes mu = dot(v, product);
  Mask good = stdx::abs(product[0] - mu * v[0]) <= Lanes(detail::kResidualTolerance);
  for (std::size_t k = 1; k < 4; ++k)
    good = good && stdx::abs(product[k] - mu * v[k]) <= Lanes(detail::kResidualTolerance);
  detail::Symmetric4<Lanes> below = shifted(N, mu + Lanes(detail::kEigenvalueTolerance));
  for (Lanes& entry : below) entry = -entry;
  const auto smaller = [](const Lanes& a, const Lanes& b) { return stdx::min(a, b); };
  return good && smallest_pivot(below, smaller) > Lanes(0);
}

void find_lane(const MatrixLanes& matrices, QuaternionLanes& rotations, int lane) {
  Mat3 A;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) A(r, c) = matrices.entries[3 * r + c][lane];
  auto& q = rotations.entries;
  const Quaternion found = find_rotation(A, Quaternion(q[0][lane], q[1][lane], q[2][lane], q[3][lane]));
  q[0][lane] = found.w();
  q[1][lane] = found.x();
  q[2][lane] = found.y();
  q[3][lane] = found.z();
}

}  // namespace

void find_rotations(const MatrixLanes& matrices, QuaternionLanes& rotations) noexcept {
  detail::Matrix9<Lanes> A;
  for (std::size_t k = 0; k < 9; ++k) A[k].copy_from(matrices.entries[k], stdx::vector_aligned);
  const Lanes shrink = Lanes(1) / greatest_entry(A);
  for (Lanes& entry : A) entry *= shrink;
  detail::Quad<Lanes> guess;
  for (std::size_t k = 0; k < 4; ++k) guess[k].copy_from(rotations.entries[k], stdx::vector_aligned);

  const detail::Symmetric4<Lanes> N = detail::davenport_matrix(A);
  Mask good(true);
  detail::Quad<Lanes> q = eigenvector(N, greatest_root(A, dot(guess, multiply(N, guess))), guess, good);
  good = good && certified(N, q);

  const Lanes alignment = dot(q, guess);
  const Mask flips = alignment < Lanes(0);
  for (std::size_t k = 0; k < 4; ++k) {
    where(flips, q[k]) = -q[k];
    where(!good, q[k]) = guess[k];
    q[k].copy_to(rotations.entries[k], stdx::vector_aligned);
  }
  if (stdx::all_of(good)) return;
  for (int lane = 0; lane < kRotationLanes; ++lane)
    if (!good[static_cast<std::size_t>(lane)]) find_lane(matrices, rotations, lane);
}

}  // namespace softreel
