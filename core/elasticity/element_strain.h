/// Strain and stress of an element as single numbers, for showing them.
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

}  // namespace softreel
