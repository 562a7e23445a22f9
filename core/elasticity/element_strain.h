/// Strain and stress of an element as single numbers and as tensors, for showing them.
#pragma once

#include "core/base/types.h"
#include "core/elasticity/material.h"

namespace softreel {

/// Deformation gradient F = [x1-x0, x2-x0, x3-x0] [X1-X0, X2-X0, X3-X0]^-1 of a tetrahedron.
/// rest: of positive volume; both in the order of the element's nodes.
Mat3 deformation_gradient(const std::array<Vec3, 4>& rest, const std::array<Vec3, 4>& deformed);

/// Principal stretches, rising: the singular values of F, the smallest one negative where the element is inverted, so
/// that F is a proper rotation times a symmetric matrix with them. 1 at rest.
Vec3 principal_stretches(const Mat3& gradient);

/// The principal strain (stretch - 1) that is largest by magnitude; its magnitude.
double largest_strain(const Vec3& stretches);

/// Von Mises stress, Pa: sqrt(3/2 s:s) of the deviator s of the corotated stress 2 mu e + lambda tr(e) I, in which
/// e = U - I has the principal strains (Biot), so that a turned element has none. What the solver's own choice of
/// rotations makes of the same shape may differ from it where strains are large.
double von_mises_stress(const Vec3& stretches, const ElementMaterial& material);

/// Green strain (F^T F - I) / 2, in the axes of the rest shape: none in a turned element; (s^2 - 1) / 2 along an axis
/// of stretch s.
Mat3 green_strain(const Mat3& gradient);

/// Cauchy stress P F^T / det F, Pa: force over deformed area, in the axes of space. first_piola: as corotated_stress
/// gives it with the polar rotation of F, which makes the result symmetric. NaN where the element is flat: its forces
/// act on no area.
Mat3 cauchy_stress(const Mat3& first_piola, const Mat3& gradient);

/// sqrt(3/2 s:s) of the deviator s of a symmetric stress.
double von_mises_of(const Mat3& stress);

}  // namespace softreel
