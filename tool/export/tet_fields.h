/// What the elements of a deformed body hold: strain and stress, as tensors and as the numbers that heat maps show.
#pragma once

#include <vector>

#include "core/base/parallel.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/material.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// A body's tetrahedra at rest and deformed, in the same axes and unit. Borrows all.
struct DeformedTets {
  const std::vector<Vec3>& rest;
  const std::vector<Vec3>& deformed;
  const std::vector<Tet>& tets;
  const std::vector<ElementMaterial>& materials;  ///< per element
  Dilatation dilatation = Dilatation::Capped;     ///< as the solver had it
};

/// One value, or one symmetric tensor (XX YY ZZ XY YZ XZ), per element. Exact in turned elements: rotations are taken
/// out by the polar decomposition, whichever way the solver found them.
struct TetFields {
  std::vector<float> strain;            ///< the principal stretch - 1 that is largest by magnitude, its magnitude
  std::vector<float> von_mises_stress;  ///< Pa, of the corotated stress, as heat maps show it
  std::vector<float> green_strain;      ///< tensors, in the axes of the rest shape
  std::vector<float> cauchy_stress;     ///< tensors, Pa, in the axes of space; NaN where an element is flat
  std::vector<float> cauchy_von_mises;  ///< Pa; where strains are small the same as von_mises_stress
};

TetFields find_tet_fields(const DeformedTets& body, const Threads& threads);

/// A number per element that is the same where all of the material is: from 0, in the order of first elements.
std::vector<Index> number_materials(const std::vector<ElementMaterial>& materials);

}  // namespace softreel
