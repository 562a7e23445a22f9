/// What a time step adds to the potential of statics: with it, the step's force balance is a minimum (design 4.4).
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/strain_damping.h"
#include "core/sparse/block_matrix.h"

namespace softreel {

/// sum_i weights_i |x_i - centers_i|^2 / 2 + the potential of `damping` + (x - base)^T D (x - base) / 2. The first is
/// inertia and the damping of mass: with the integrator's bases x', v' and seconds t, r of TimeStep its gradient is M a
/// + Ma v for v = (x - x') / r, a = (v - v') / t. The second is the damping of stiffness
/// (core/elasticity/strain_damping.h). The third is that of elements so distorted that the second is far from its
/// tangent: by velocities in frozen axes.
struct StepPotential {
  std::vector<double> weights;  ///< per node, N/m
  std::vector<Vec3> centers;    ///< per node, m
  StrainDamping damping;
  std::vector<Vec3> base_positions = {};  ///< per node, m
  BlockMatrixd frozen_damping = {};       ///< D, N/m; no values: nothing of this kind

  bool has_frozen_damping() const { return !frozen_damping.values.empty(); }

  /// Fills the potential's forces on the nodes, N. rotations: those of the elastic forces at `positions`.
  DampingEnergy evaluate(const ElasticBody& body, std::span<const Vec3> positions,
                         std::span<const Quaternion> rotations, std::span<Vec3> forces, const Threads& threads) const;
};

}  // namespace softreel
