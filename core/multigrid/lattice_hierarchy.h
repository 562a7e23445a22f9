/// Nested lattice levels over one mesh: patterns, colours and transfers; everything that no matrix value changes.
#pragma once

#include <span>
#include <vector>

#include "core/multigrid/multigrid.h"
#include "core/multigrid/transfer.h"
#include "core/sparse/block_matrix.h"
#include "core/sparse/weight_matrix.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// One level. Its nodes are numbered by colour, so that rows of one colour are contiguous and share no block, and the
/// blocks left of the diagonal are those of earlier colours.
struct LatticeLevel {
  BlockPattern pattern;
  std::vector<Index> color_offsets;    ///< colour c owns the rows [color_offsets[c], color_offsets[c + 1])
  std::vector<std::int64_t> diagonal;  ///< position of each row's diagonal block
  std::vector<Index> rank;             ///< each row's place before the colouring: near rows have near ranks
  WeightMatrix restriction;            ///< R: next level's rows by this level's columns; empty on the last level
  WeightMatrix prolongation;           ///< R^T
};

struct LatticeHierarchy {
  std::vector<LatticeLevel> levels;  ///< levels[0] is the mesh; never empty
  std::vector<Index> mesh_nodes;     ///< mesh node of each node of level 0
  /// Block of the mesh's pattern behind each block (i, j) of level 0, mirrored: that of K_ji. Copied as it is, a level
  /// holds its blocks column-major, as column_major_row_product wants them; R K R^T keeps that.
  std::vector<std::int64_t> source_blocks;
};

/// Lattices of spacing 2h, 4h, ... with the mesh's origin, until a level has at most params.bottom_nodes nodes or is
/// cheap to factor anyway, or until the next would hardly be smaller (many separate pieces). A mesh without a lattice
/// (spacing 0) gets one from its median volume. element_stiffness and pattern: as for Multigrid.
LatticeHierarchy build_lattice_hierarchy(const TetMesh& mesh, std::span<const double> element_stiffness,
                                         const BlockPattern& pattern, const MultigridParams& params);

}  // namespace softreel
