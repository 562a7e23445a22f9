/// The rotation of an element, found safely for every deformation (paper sec. 3, design 4.2).
///
/// The rotation nearest to a 3x3 matrix A maximises tr(R^T A) = q^T N(A) q over unit quaternions, N the symmetric
/// matrix of Davenport and Horn. With A = sum (x_i - c)(X_i - c0)^T = F S this is the minimiser of the paper's eq. (3);
/// with A = F it is the proper polar rotation, whose force is the gradient of an energy. Every eigenvector of N makes
/// the paper's eqs. (5)-(8) vanish, so unlike the paper a result is accepted only if its eigenvalue is the greatest.
#pragma once

#include <span>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/element.h"

namespace softreel {

/// Rotation R that maximises tr(R^T A).
///
/// Rayleigh quotient iteration (Newton on quaternion and multiplier) from `guess`, accepted if mu I - N is positive
/// semidefinite; else the greatest root of the characteristic quartic by monotone Newton from an upper bound, and its
/// eigenvector from the adjugate; where that root is multiple (A of rank one, mirrored or point-reflected ties,
/// collapsed to a point) the projection of `guess` on the eigenspace by a Jacobi decomposition, and a fixed member of
/// it if the projection vanishes. Scale-invariant. A proper rotation for any A; `guess` if A is zero or not finite.
/// guess: unit quaternion. The result has the sign nearest to it. Pure, thread-safe, allocates nothing.
Quaternion find_rotation(const Mat3& A, const Quaternion& guess) noexcept;

/// Rotation Q that carries the rest tetrahedron onto the deformed one with least squared distance, eq. (3).
///
/// rest, deformed: 4 nodes, m, same order. Any finite input gives a proper rotation; ties go to the one nearest
/// `guess`. The scalar reference: rotations of a mesh are found by element_moment and find_rotations.
Quaternion find_element_rotation(const TetNodes& rest, const TetNodes& deformed, const Quaternion& guess) noexcept;

/// A = sum (x_i - c)(X_i - c0)^T of eq. (3), m^2.
Mat3 element_moment(const TetNodes& rest, const TetNodes& deformed);

/// Elements that the batched kernel works on at once, whatever the width of the machine's registers: enough to keep
/// four of AVX2 in flight through the chain of Newton steps.
inline constexpr int kRotationLanes = 16;

/// A of one batch: entry (r, c) of lane l is entries[3 r + c][l].
struct alignas(128) MatrixLanes {
  double entries[9][kRotationLanes];
};

/// Rotations of one batch as (w, x, y, z)[lane].
struct alignas(128) QuaternionLanes {
  double entries[4][kRotationLanes];
};

/// find_rotation of each lane, to round-off (at ties: another member of the same eigenspace only where the guess has no
/// projection on it). rotations: guesses in, results out. Lanes that the fast path cannot certify go to find_rotation.
void find_rotations(const MatrixLanes& matrices, QuaternionLanes& rotations) noexcept;

}  // namespace softreel
