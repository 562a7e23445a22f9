/// What the elements bring to one implicit time step, in one pass: the matrix's gradients in float, and the forces of
/// the right side in double.
///
/// Bound: an element reads 128 bytes of rest shape, 40 of rotation and share, its nodes from cache, and writes 64 + 96
/// bytes; about 330 multiplies and adds, 8 to 10 ns in four lanes of AVX2.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/aligned.h"
#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/elastic_body.h"

namespace softreel {

/// Terms of the system S d = h f - C h v - h^2 K v of core/dynamics/step.cpp.
struct StepTerms {
  /// g_i = sqrt(s V mu) Q b_i as x y z r with r = slope of the dilatation stress over mu: elements x 4 x 4.
  /// Block (i, j) of S gains r g_i g_j^T + g_j g_i^T + (g_i . g_j) I.
  AlignedVector<float> gradients;
  /// h V Q sigma and s times the derivative of V Q sigma along the velocities, as forces -T b_i on the nodes, N s:
  /// elements x 4 x 3, and one scalar more for the lanes of the last.
  AlignedVector<double> forces;
  /// True if r is the same in all elements.
  bool uniform_ratio = false;
};

/// The state that a step starts from.
struct StepSource {
  std::span<const Vec3> positions;            ///< per node, m
  std::span<const Vec3> velocities;           ///< per node, m/s
  std::span<const Quaternion> rotations;      ///< per element
  double seconds = 0;                         ///< h
  std::span<const double> damping_stiffness;  ///< b per element, s; the element's share in S is s = h^2 + h b
};

/// Fills `terms`; the vector twin of find_stiffness_terms, find_stresses and the product with K.
void find_step_terms(const ElasticBody& body, const StepSource& source, StepTerms& terms, const Threads& threads);

/// Sum of the elements' forces on each node, in the order of elements.
void gather_step_forces(const NodeElements& node_elements, const StepTerms& terms, std::span<Vec3> forces,
                        const Threads& threads);

/// The batches [begin, end) of find_step_terms; returns how many elements have another ratio than `expected_ratio`.
std::int64_t find_step_batches(std::span<const ElementBatch> batches, const StepSource& source, float expected_ratio,
                               StepTerms& terms, std::size_t begin, std::size_t end);

}  // namespace softreel
