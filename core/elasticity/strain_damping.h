/// Damping of stiffness where a step balances its forces at its end: a potential of how far each element has gone from
/// turned copies of a stretch it had.
///
/// With the strain rate (U - U') / r, U' being what the integrator's difference takes of stretches before, each element
/// has the potential b / r V (mu min_Q |F - Q U'|^2 + p / 2 (tr U - tr U')^2) over all rotations Q; U is the stretch of
/// the polar F = R U and p the slope of the dilatation stress. It is zero for F = Q U', whatever Q: what turns rigidly
/// is not damped, by however much it turns in a step. A dissipation potential must be so (Brown, Overby, Forootaninia
/// and Narain, Accurate Dissipative Forces in Optimization Integrators, 2018): b C : sym(R*^T grad v) with frozen
/// rotations R*, which is what one linear solve damps by, sees a turn by w as a strain of w^2 / 2, and the more of it
/// the stiffer the element. To first order in the strain of a step both are the same.
///
/// Its gradient is exact and simple: where Q and R are maximisers (of Q^T F U' and of R^T F) they count as fixed
/// (Danskin 1966). P F^T is symmetric, so that no torque is left, and the potential is continuous where rotations jump.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/curvature_batch.h"
#include "core/elasticity/elastic_body.h"

namespace softreel {

struct StrainDamping {
  std::vector<double> ratios;   ///< b / r per element; empty: nothing is damped
  std::vector<double> slopes;   ///< p per element, Pa
  std::vector<Mat3> stretches;  ///< U' per element
  /// That of the elastic forces. With None (small strain) Q and R are identities and U is sym(F).
  RotationMethod rotation = RotationMethod::Consistent;

  bool empty() const { return ratios.empty(); }
};

/// Energy, and how far the rounding of positions may put it wrong, J.
struct DampingEnergy {
  double value = 0, noise = 0;
};

/// sym(R^T F) of every element at `positions`, R polar; with rotation None R = I. guesses: rotations nearby.
std::vector<Mat3> find_stretches(const ElasticBody& body, RotationMethod rotation, std::span<const Vec3> positions,
                                 std::span<const Quaternion> guesses, const Threads& threads);

/// Fills the weighted stresses V P of all elements, whose forces are those of gather_forces. rotations: as
/// damping.rotation has them at `positions`. Not for an empty damping.
DampingEnergy find_damping(const ElasticBody& body, const StrainDamping& damping, std::span<const Vec3> positions,
                           std::span<const Quaternion> rotations, std::span<Mat3> stresses, const Threads& threads);

/// What turning adds to the damping's tangent beside stiffness of the share b / r: matrix += factor b / r times
/// rotation_curvature as though U - U' were the strain, right to first order in it. rotation: polar one of F.
void add_damping_curvature(const ElasticLaw& law, const StrainDamping& damping, std::size_t element,
                           const Mat3& rotation, const Mat3& F, double factor, CurvatureBatch& batch, Mat3& matrix);

}  // namespace softreel
