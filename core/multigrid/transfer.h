/// Transfer between a level and the next coarser one: which coarse nodes there are, and their weights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/sparse/block_kernels.h"
#include "core/sparse/weight_matrix.h"
#include "core/tetmesh/lattice/bcc_lattice.h"

namespace softreel {

/// What coarsening knows of a level.
struct LevelNodes {
  std::vector<Vec3> positions;  ///< rest positions, m
  /// Young's modulus, Pa, per block of the level's pattern: of the stiffest element that has both nodes; on the
  /// diagonal, of the stiffest around the node. Empty: homogeneous.
  std::vector<double> block_stiffness;
  /// Distance between neighbours around each node, m: a node whose neighbours are about as far as the coarse lattice's
  /// stays as it is. Empty: all are nearer.
  std::vector<double> spacings = {};
};

struct CoarseningParams {
  double dropped_weight = 0.1;     ///< barycentric weights below are dropped, the rest renormalised
  double stiffness_contrast = 10;  ///< an edge whose ends differ by more does not connect
};

/// A coarser level and the way to it.
struct Coarsening {
  LevelNodes nodes;
  WeightMatrix prolongation;  ///< R^T: fine rows by coarse columns; rows sum to 1
  Index staying = 0;          ///< fine nodes that stay as they are: a coarser lattice will take them
};

/// Coarse nodes from the lattice `frame` (of the coarse spacing) for a fine level.
///
/// A fine node depends on the corners of the lattice tetrahedron that contains its rest position, with barycentric
/// weights. A corner becomes one coarse node per connected part of the fine nodes that depend on it, where connected
/// means: by edges of `pattern` that are not much softer than an end. So two legs that pass the same corner do not
/// share a coarse node, nor do a hard inclusion and the flesh around it, nor two inclusions with a layer of flesh
/// between. Coarse nodes are ordered by lattice position, copies by their first fine node; nodes that stay come after
/// them. Stiffnesses are left empty: they need the coarse pattern (restrict_stiffness).
Coarsening coarsen(const LevelNodes& fine, const BlockPattern& pattern, const LatticeFrame& frame,
                   const CoarseningParams& params);

/// Stiffness per block of `coarse_pattern` = galerkin_pattern(pattern, R, R^T): the largest of those it gathers.
std::vector<double> restrict_stiffness(const std::vector<double>& block_stiffness, const BlockPattern& pattern,
                                       const WeightMatrix& prolongation, const BlockPattern& coarse_pattern);

/// coarse = R fine.
template <typename Scalar>
void restrict_to(const WeightMatrix& restriction, const NodeVector<Scalar>& fine, NodeVector<Scalar>& coarse,
                 const Threads& threads);

/// fine += R^T coarse; nodes with fixed[i] != 0 stay (empty: none).
template <typename Scalar>
void prolong_add(const WeightMatrix& prolongation, std::span<const std::uint8_t> fixed,
                 const NodeVector<Scalar>& coarse, NodeVector<Scalar>& fine, const Threads& threads);

}  // namespace softreel
