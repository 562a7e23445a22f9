/// Boxes of body-centred cubic tetrahedra and their matrices of linear elasticity, for tests and benchmarks of solvers.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/sparse/block_matrix.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel::test_support {

/// A box of nx x ny x nz cubes of edge h with its low corner at the origin, filled with BCC tetrahedra: four around
/// each inner face of a cube, two pyramid halves on each outer one. `keep` (empty: all) chooses the cubes by index;
/// nodes of no element are left out.
TetMesh make_box(std::array<Index, 3> cubes, double h, const std::function<bool(Index, Index, Index)>& keep = {});

/// The bar of the performance targets: 1 x 0.25 x 0.25 m, `across` cubes across.
TetMesh make_bar(Index across);

/// Where a box or bar begins: what tests pin.
inline bool at_left_end(const Vec3& x) {
  return x[0] < 1e-9;
}

struct ElasticParams {
  double youngs_modulus = 1e6;  ///< Pa
  double poisson_ratio = 0.4;
  double density = 1000;  ///< kg/m^3
  double seconds = 0;     ///< implicit time step: adds M / seconds^2; 0: static
};

/// A matrix with pins and the load that goes with it.
struct ElasticSystem {
  BlockMatrixd matrix;
  std::vector<std::uint8_t> pinned;
  std::vector<Vec3> load;  ///< gravity along -y on what is not pinned, N
};

/// K_ij = sum V (lambda a_i a_j^T + mu a_j a_i^T + mu a_i.a_j I), a = Q b, plus lumped masses over seconds^2.
///
/// stiffness_factor: per element, multiplies E; empty: 1. rotations: Q per element; empty: identity. is_pinned: by rest
/// position; pinned rows and columns are zero but for the mean diagonal on the diagonal.
ElasticSystem assemble(const TetMesh& mesh, const ElasticParams& params,
                       const std::function<bool(const Vec3&)>& is_pinned, std::span<const double> stiffness_factor = {},
                       std::span<const Mat3> rotations = {});

/// |b - A x| / |b|, computed plainly.
double relative_residual(const BlockMatrixd& A, const std::vector<Vec3>& b, const std::vector<Vec3>& x);

/// The matrix with 3 n x 3 n scalars.
Eigen::MatrixXd dense(const BlockMatrixd& A);

}  // namespace softreel::test_support
