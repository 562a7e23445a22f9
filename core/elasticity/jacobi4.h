/// All eigenvectors of a symmetric 4x4 matrix by cyclic Jacobi rotations: slow, and right for every input.
#pragma once

#include <array>

#include "core/elasticity/davenport.h"

namespace softreel::detail {

/// values[k] belongs to the unit vector vectors[k]; the vectors are orthonormal, in no particular order.
struct Eigen4 {
  std::array<double, 4> values;
  std::array<Quad<double>, 4> vectors;
};

/// Eigenvalues and eigenvectors to round-off of the greatest entry. m: finite, of moderate scale.
Eigen4 jacobi_eigen(const Symmetric4<double>& m);

}  // namespace softreel::detail
