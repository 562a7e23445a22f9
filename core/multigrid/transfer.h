/// Transfer between a level and the next coarser one: which coarse nodes there are, and their weights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/sparse/block_kernels.h"
#include "core/sparse/weight_matrix.h"
#include "core/tetmesh/bcc_lattice.h"

namespace softreel {

/// What coarsening knows of a level's nodes.
struct LevelNodes {
  std::vector<Vec3> positions;    ///< rest positions, m
  std::vector<double> stiffness;  ///< Young's modulus of the stiffest element around, Pa; empty: homogeneous
};

struct CoarseningParams {
  double dropped_weight = 0.1;     ///< barycentric weights below are dropped, the rest renormalised
  double stiffness_contrast = 10;  ///< an edge whose ends differ by more does not connect
};

/// A coarser level and the way to it.
struct Coarsening {
  LevelNodes nodes;
  WeightMatrix prolongation;  ///< R^T: fine rows by coarse columns; rows sum to 1
};

/// Coarse nodes from the lattice `frame` (of the coarse spacing) for a fine level.
///
/// A fine node depends on the corners of the lattice tetrahedron that contains its rest position, with barycentric
/// weights. A corner becomes one coarse node per connected part of the fine nodes that depend on it, where connected
/// means: by edges of `pattern` that do not cross a stiffness contrast. So two legs that pass the same corner, or the
/// two sides of a hard inclusion, do not share a coarse node.
/// Coarse nodes are ordered by lattice position, copies by their first fine node.
Coarsening coarsen(const LevelNodes& fine, const BlockPattern& pattern, const LatticeFrame& frame,
                   const CoarseningParams& params);

/// coarse = R fine.
template <typename Scalar>
void restrict_to(const WeightMatrix& restriction, const NodeVector<Scalar>& fine, NodeVector<Scalar>& coarse,
                 const Threads& threads);

/// fine += R^T coarse; nodes with fixed[i] != 0 stay (empty: none).
template <typename Scalar>
void prolong_add(const WeightMatrix& prolongation, std::span<const std::uint8_t> fixed,
                 const NodeVector<Scalar>& coarse, NodeVector<Scalar>& fine, const Threads& threads);

}  // namespace softreel
