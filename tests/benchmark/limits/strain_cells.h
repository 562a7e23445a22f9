/// Small-strain statics of any discretisation whose strain is known at points: what limits.cpp compares elements by.
///
/// Small strain, for locking is a matter of which strains an element can have, not of how far it is turned: a corotated
/// element locks as its unrotated twin does.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/SparseCore>

#include "core/base/types.h"

namespace softreel::bench {

/// Isotropic, Pa.
struct Lame {
  double lambda = 0, mu = 0;
  static Lame of(double youngs_modulus, double poisson_ratio);
  double bulk() const { return lambda + 2 * mu / 3; }
};

/// Strain sym(sum u_i b_i^T) at one point, and the energy weight (lambda/2 tr^2 + mu eps:eps) that it brings.
struct StrainPoint {
  double weight = 0;  ///< m^3
  Lame material;
  Eigen::Matrix3Xd gradients;    ///< b_i, 1/m, one column per node of the cell
  Eigen::VectorXd values;        ///< shape functions, for loads; empty where the point carries none
  Vec3 position = Vec3::Zero();  ///< m, for loads
};

/// The nodes that its points' strains depend on.
struct StrainCell {
  std::vector<Index> nodes;
  std::vector<StrainPoint> points;
};

struct Discretization {
  std::vector<Vec3> nodes;  ///< m
  std::vector<StrainCell> cells;
};

/// Displacement of a node, per component: held at zero or free.
using HeldComponents = std::function<std::array<bool, 3>(const Vec3& node)>;
/// Body force, N/m^3.
using BodyForce = std::function<Vec3(const Vec3& position)>;

struct HeldDisplacements {
  std::vector<Vec3> displacements;          ///< per node, m
  std::int64_t unknowns = 0, nonzeros = 0;  ///< of the matrix without what is held, both halves
  double solve_seconds = 0;                 ///< processor time of sparse LDL^T: ordering, factorisation, solution
};

/// Throws std::runtime_error if the stiffness is not definite.
HeldDisplacements solve_statics(const Discretization& discretization, const HeldComponents& held,
                                const BodyForce& force);

}  // namespace softreel::bench
