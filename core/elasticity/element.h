/// One linear tetrahedron: shape, deformation gradient, corotated stress, energy and stiffness (design 4.3).
#pragma once

#include <array>

#include "core/base/types.h"

namespace softreel {

/// Four nodes of a tetrahedron, m, in the order of its Tet.
using TetNodes = std::array<Vec3, 4>;

/// Column i is the gradient of the shape function of node i, constant per element, 1/m. Unaligned, so that arrays of it
/// have no holes.
using Gradients = Eigen::Matrix<double, 3, 4, Eigen::DontAlign>;

/// Rest shape of an element.
struct ElementShape {
  Gradients gradients;  ///< b_i; their sum is zero
  double volume = 0;    ///< m^3, positive for the project's orientation
};

/// Gradients and volume of the rest tetrahedron. A flat one has volume 0 and gradients that are not finite.
ElementShape find_element_shape(const TetNodes& rest);

/// F = sum x_i b_i^T, taken from node 0 so that a far placement costs no digits.
Mat3 deformation_gradient(const Gradients& gradients, const TetNodes& positions);

/// Isotropic linear material on the corotated strain eps = sym(Q^T F) - I, with an optional cap on the dilatation
/// stress p.
///
/// The linear law has p = lambda tr(eps) without bound, and its thickness across a stretch reaches zero at stretch
/// 1 + 1/nu, where every rotation method starts to flutter. Capped, p <= 2 mu (1 - kThinnest), so that a stretched
/// element keeps at least kThinnest of its thickness: free lateral faces have 2 mu (s - 1) + p = 0, hence
/// s = 1 - p / (2 mu). The force stays the gradient of a continuous energy.
///
/// Where the cap acts: from tr(eps) = (1 - kThinnest) (1 - 2 nu) / nu, which under uniaxial stress is the stretch
/// 1 + 0.7 / nu (3.3 at nu 0.3, 2.6 at 0.45, 2.4 at 0.499), so a stretch below 30 % is never touched. Under
/// all-round tension it is reached earlier (trace strain 0.93 at nu 0.3, 0.16 at 0.45, 0.003 at 0.499), always at the
/// same tension, 1.4 mu: there rubber-like materials tear holes (Gent and Lindley 1959: 2.5 mu) and stop being linear.
/// No cap by the trace alone can both start later and keep the thickness; one that looks at the deviatoric strain
/// too softens shear by lambda, which is no minimum at nu near 0.5.
struct ElasticLaw {
  static constexpr double kThinnest = 0.3;

  double lambda = 0;   ///< Lame's first parameter, Pa
  double mu = 0;       ///< shear modulus, Pa
  bool capped = true;  ///< cap the dilatation stress

  double pressure_limit() const { return 2 * mu * (1 - kThinnest); }
  bool at_limit(double trace) const { return capped && lambda * trace > pressure_limit(); }

  /// Dilatation stress p at trace strain `trace`, Pa; positive is tension.
  double pressure(double trace) const { return at_limit(trace) ? pressure_limit() : lambda * trace; }
  /// dp / dtrace: lambda, or 0 at the limit.
  double pressure_slope(double trace) const { return at_limit(trace) ? 0.0 : lambda; }
  /// Energy density whose derivative by `trace` is p, J/m^3.
  double pressure_energy(double trace) const;
};

/// eps = sym(Q^T F) - I.
Mat3 corotated_strain(const Mat3& rotation, const Mat3& F);

/// First Piola stress Q sigma with sigma = p I + 2 mu eps, Pa. The element's force on node i is -V Q sigma b_i.
Mat3 corotated_stress(const ElasticLaw& law, const Mat3& rotation, const Mat3& F);

/// Energy density mu eps:eps + pressure_energy(tr eps), J/m^3. With Q the polar rotation of F its gradient by F is
/// corotated_stress.
double corotated_energy(const ElasticLaw& law, const Mat3& rotation, const Mat3& F);

/// Stiffness of the rotated element, 12 x 12 of 3 x 3 blocks
/// K_ij = V (lambda a_i a_j^T + mu a_j a_i^T + mu (a_i . a_j) I), a_i = Q b_i; lambda is passed for the slope of a cap.
Eigen::Matrix<double, 12, 12> element_stiffness(const ElementShape& shape, double lambda, double mu,
                                                const Mat3& rotation);

/// What the rotation adds to the stiffness as it turns with the element (design 4.4): C = sum_k kappa_k / 2 m_k m_k^T,
/// kappa_k = 2 mu - 2 (2 mu - p) / (s_i + s_j), m_k the principal axes of stretch in space and s their stretches.
///
/// The block of nodes i, j gains V [a_i]x C [a_j]x^T = V/2 sum_k kappa_k (m_k x a_i)(m_k x a_j)^T, which makes the
/// tangent of the consistent rotation exact. positive_part: kappa_k^+ instead, so that the sum stays semidefinite.
/// Where two stretches nearly cancel (an inversion) s_i + s_j is taken as kSmallestStretchSum at least: kappa has a
/// pole there.
Mat3 rotation_curvature(const ElasticLaw& law, const Mat3& rotation, const Mat3& F, bool positive_part);
inline constexpr double kSmallestStretchSum = 1e-3;

}  // namespace softreel
