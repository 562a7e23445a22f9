/// Dense algebra by Eigen for several tests: compiled once, as its templates take long.
#pragma once

#include <Eigen/Core>

namespace softreel::test_support {

/// Of a symmetric matrix, ascending.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);

/// A x = value B x, values ascending. Vectors are columns, orthonormal by B.
struct EigenPairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
/// A: symmetric; B: symmetric, positive definite.
EigenPairs generalized_eigenpairs(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// X of A X = B, for a regular A.
Eigen::MatrixXd solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace softreel::test_support
