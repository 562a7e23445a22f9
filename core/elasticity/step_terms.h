/// What the elements bring to one implicit time step, in one pass: the matrix's gradients in float, and the forces of
/// the right side in double.
///
/// Bound: an element reads 120 bytes of rest shape, 48 of rotation, share and places, its nodes from cache, and writes
/// 64 bytes; about 350 multiplies and adds, 8 to 10 ns in four lanes of AVX2. One under tension that the step must know
/// of takes 800 more, with 24 divisions and 24 roots, and 48 bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned.h"
#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/assembly.h"
#include "core/elasticity/elastic_body.h"

namespace softreel {

/// Floats that one element's curvature takes: three rows of three, each with one that is not used.
inline constexpr std::size_t kCurvatureFloats = 12;

/// Terms of the system of core/dynamics/step_system.cpp.
struct StepTerms {
  /// g_i = sqrt(s V mu) Q b_i as x y z r with r = step_pressure_slope over mu: elements x 4 x 4.
  /// Block (i, j) of S gains r g_i g_j^T + g_j g_i^T + (g_i . g_j) I.
  AlignedVector<float> gradients;
  /// C of core/elasticity/tension.h, by whose share block (i, j) gains [g_i]x C [g_j]x^T: per slab, empty where no
  /// element has tension that the step must know of, else elements x kCurvatureFloats, zero for those without.
  std::vector<AlignedVector<float>> curvatures;
  /// Per slab: 1 if a gradient or curvature of it was replaced. Whoever makes a matrix of the gradients sets it back to
  /// 0.
  std::vector<std::uint8_t> changed;
  /// With T = t V Q sigma, t times the derivative of V Q sigma along the offsets and s times that along the velocities:
  /// the forces -T b_i on the nodes, N s, added up by slabs. Derivatives are at fixed rotations, but for the
  /// curvatures, and at the limit of the dilatation stress they are what step_pressure_slope says.
  AlignedVector<double> forces;
  /// True if r is the same in all elements.
  bool uniform_ratio = false;

  /// Three rows of an element's C; null if its slab has none.
  const float* curvature_of(std::size_t element) const {
    constexpr std::size_t kSlabElements = kSlabBatches * kElementLanes;
    const AlignedVector<float>& slab = curvatures[element / kSlabElements];
    return slab.empty() ? nullptr : slab.data() + kCurvatureFloats * (element % kSlabElements);
  }
};

/// How far one step reaches: with the acceleration a and the velocity v at its end, v = base + velocity_seconds * a and
/// the positions are base + position_seconds * v, the bases being those of the integrator (core/dynamics/time_step.h).
struct StepSeconds {
  double velocity = 0, position = 0;
  bool operator==(const StepSeconds&) const = default;
};

/// The state that the elements are linearised at, and where the step goes from there.
struct StepSource {
  std::span<const Vec3> positions;            ///< per node, m
  std::span<const Vec3> velocities;           ///< at the step's end, per node, m/s
  std::span<const Quaternion> rotations;      ///< per element
  StepSeconds seconds;                        ///< t = seconds.velocity
  std::span<const double> damping_stiffness;  ///< b per element, s; its share in S is s = t (seconds.position + b)
  /// The positions at the step's end less those above and seconds.position * velocities, m; empty: zero.
  std::span<const Vec3> offsets;
  /// Gradients that change by less than this share of themselves, r that does of 1 + r, and curvatures that change by
  /// less than it, are left as they are; negative: none is.
  double kept_change = -1;
  /// Pa s, per lane of the body's batches: find_tension_limits. Empty: no curvatures.
  std::span<const double> tension_limits = {};
  bool secant_at_limit = false;  ///< of step_pressure_slope: to be taken where the positions are extrapolated
  /// Of the step's start, where the positions above are extrapolated from there: tension is no greater than it was then
  /// (core/elasticity/tension.h). Empty: it is that of the positions above.
  std::span<const Vec3> start_positions = {};
  std::span<const Quaternion> start_rotations = {};
};

/// Slope of the dilatation stress p that a step of one solve reckons with, Pa; reach = seconds.position, damping = b.
///
/// At the limit the tangent is 0: an element that goes back below it within the step meets lambda, of which the matrix
/// knows nothing. From the step's start Euler bears that. From an extrapolated place soft bodies crumple wherever they
/// are stretched to the limit: there elasticity takes the secant p / trace. The energy of a capped p is Huber's
/// function of the trace, and the parabola of the secant touches it and lies above it everywhere, so the step never
/// takes energy for less than it is (iteratively reweighted least squares; Holland and Welsch 1977).
///
/// Greater than the tangent, it slows changes of volume by an error of the order of the way from the place of
/// linearisation to the end: of second order from an extrapolated place, but of first from the start. lambda, the
/// greatest slope, would leave volumes no force but inertia's: they would go on as they are extrapolated. Damping has
/// the tangent in any case.
inline double step_pressure_slope(const ElasticLaw& law, double trace, bool secant, double reach, double damping) {
  if (!law.at_limit(trace)) return law.lambda;
  return secant && reach > 0 ? law.pressure_limit() / trace * reach / (reach + damping) : 0;
}

/// Gives terms of find_stiffness_terms, which are the tangent's, the slopes of a step.
void take_step_slopes(const ElasticBody& body, const StepSource& source, StiffnessTerms& terms, const Threads& threads);

/// Fills `terms`; the vector twin of find_stiffness_terms, find_stresses and the product with K.
void find_step_terms(const ElasticBody& body, const StepSource& source, StepTerms& terms, const Threads& threads);

/// Sum of the elements' forces on each node.
void gather_step_forces(const ElasticBody& body, const StepTerms& terms, std::span<Vec3> forces,
                        const Threads& threads);

/// One slab of find_step_terms; returns how many of its elements have another ratio than `expected_ratio`.
std::int64_t find_step_slab(const ElasticBody& body, const StepSource& source, float expected_ratio, StepTerms& terms,
                            std::size_t slab);

}  // namespace softreel
