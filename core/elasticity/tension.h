/// The stiffness that tension adds to an element, for steps that linearise once (design 4.4).
///
/// A taut string resists by its tension, not by its bending. One solve a step that leaves that out of its matrix is an
/// explicit method for it: implicit Euler with forces of the step's start and S = M + t r K is stable as long as
/// u^T G u <= u^T K u + 4 / (t r) u^T M u, G being what is left out. So bodies fluttered that are stiff, slender or far
/// stretched for their step. Here G enters, but for what is harmless: bodies of which nothing is under such tension are
/// not touched.
#pragma once

#include <span>
#include <vector>

#include "core/base/aligned.h"
#include "core/base/parallel.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/material.h"
#include "core/elasticity/step_terms.h"

namespace softreel {

/// What a step of seconds t, r may leave out of its matrix, times sqrt(t r): the limit of kappa_k of
/// rotation_curvature, Pa s, per lane of body.batches; infinite in lanes without an element.
///
/// Of a plate of thickness d that bends at the wave number k, per volume and by the square of its deflection, G is
/// 2 kappa k^2, K is E d^2 k^4 / 12 and M is rho: kappa is harmless at every k up to d sqrt(E rho / (3 t r)). Taken is
/// `share` of that, with find_thickness for d. thickness, materials: per element.
AlignedVector<double> find_tension_limits(const ElasticBody& body, std::span<const double> thickness,
                                          const std::vector<ElementMaterial>& materials, double share);

/// rotation_curvature with (kappa_k - least)^+ for kappa_k: continuous, so that steps stay smooth in the state.
Mat3 tension_curvature(const ElasticLaw& law, const Mat3& rotation, const Mat3& F, double least);

/// Extrapolation from the last steps to where one linearises stretches what turns, by three quarters of the square of
/// its turn in a step (linearization_positions): tension that is not there, and whose stiffness would hold the end to
/// that place's turn, which lags. A plate that spun at two turns a second in 96 steps lost a third of its energy. So
/// taken is the tension of the step's start, if that of the extrapolated place is greater; where it is less, the former
/// scaled to its greatest value, so that steps stay smooth in the state.
///
/// r / (r + b) times tension_curvature over mu per element: StiffnessTerms::curvatures for the matrix S of a step
/// (damping has no such stiffness: it would brake what spins). The scalar twin of what find_step_terms does on the way.
/// Empty if no element has any.
std::vector<Mat3> find_tension_curvatures(const ElasticBody& body, const StepSource& source, const Threads& threads);

}  // namespace softreel
