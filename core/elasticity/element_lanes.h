/// Rest shapes and laws of the elements in vector lanes, for the kernels that work on a few elements at once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned.h"
#include "core/base/types.h"
#include "core/elasticity/element.h"

namespace softreel {

/// Elements of one batch, whatever the width of the machine's registers.
inline constexpr std::size_t kElementLanes = 4;

/// One batch; entry l of each array is that of element kElementLanes * batch + l. Lanes without an element repeat the
/// last one.
struct alignas(32) ElementBatch {
  double gradients[9][kElementLanes];    ///< b_1, b_2, b_3 (b_0 is minus their sum), x y z each, 1/m
  double volume[kElementLanes];          ///< m^3
  double lambda[kElementLanes];          ///< Pa
  double mu[kElementLanes];              ///< Pa
  double pressure_limit[kElementLanes];  ///< Pa; infinite for a law without a cap
  Index nodes[4][kElementLanes];
};

/// Share of its rest volume below which an element is flat: inverted, or so near to it that the next step may invert
/// it.
inline constexpr double kFlatVolume = 0.01;

std::vector<ElementBatch> make_element_batches(const std::vector<Tet>& tets, const std::vector<ElementShape>& shapes,
                                               const std::vector<ElasticLaw>& laws);

/// Rotations nearest to the deformation gradients of all elements of the batches [begin, end), by Newton from the
/// guesses; the vector twin of find_rotation.
///
/// With S = Q^T F the turn that takes Q to the stationary point is w = (tr S I - sym S)^-1 axial(S), and where that
/// matrix is positive definite the point is the greatest maximum of tr(Q^T F): the same certificate as that of
/// Davenport's matrix, in three dimensions. The third derivative vanishes there, so convergence is cubic; from the
/// rotation of the step before two turns do. Lanes that are not certified after a few go to find_rotation.
/// rotations: per element, guesses in, results out. Returns how many elements have det F below kFlatVolume, as F is at
/// hand.
std::int64_t find_consistent_rotations(std::span<const ElementBatch> batches, std::span<const Vec3> positions,
                                       std::span<Quaternion> rotations, std::size_t begin, std::size_t end);

}  // namespace softreel
