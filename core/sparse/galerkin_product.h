/// E = R K R^T as written in eq. (9): the reference that the stream and the gather are tested and measured against.
#pragma once

#include "core/sparse/block_matrix.h"
#include "core/sparse/weight_matrix.h"

namespace softreel {

/// Fills E.values, which must have room; E.pattern is galerkin_pattern(K.pattern, R, transpose(R)). Every entry E_ij
/// visits R_il, then the intersection of the sorted sets S^K_l and S^R_j. One thread. Works for any K, symmetric or
/// not.
template <typename Scalar>
void galerkin_product(const BlockMatrix<Scalar>& K, const WeightMatrix& R, BlockMatrix<Scalar>& E);

}  // namespace softreel
