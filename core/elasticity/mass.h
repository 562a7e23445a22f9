/// Lumped nodal masses.
///
/// Lumped, not consistent: a diagonal mass keeps M + h C + h^2 K as diagonally heavy as it can be, a free fall is exact
/// for every node, and the error against the consistent mass is of the same second order in the element size.
#pragma once

#include <vector>

#include "core/elasticity/material.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Per node, kg and kg/s.
struct NodalMasses {
  std::vector<double> mass;     ///< a quarter of each element's mass
  std::vector<double> damping;  ///< the same times the element's damping_mass: the mass part of Rayleigh damping
};

/// materials: per element. Elements are added in their order.
NodalMasses lump_masses(const TetMesh& mesh, const std::vector<ElementMaterial>& materials);

}  // namespace softreel
