/// How thick a body is where an element is: what its bending is measured against.
#pragma once

#include <span>
#include <vector>

#include "core/sparse/block_matrix.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Per element, m: the diameter of the thickest ball of the body that reaches it, and at least its least height.
///
/// A ball is centred on a node and ends at the node nearest to it that is on the boundary, or where two elements meet
/// whose moduli differ more than twice: a stiff core bends by its own thickness. It reaches twice its
/// radius, as that round a cube's middle must to have the cube's corners. moduli: per element. neighbors:
/// stiffness_pattern of the mesh. Cost: about that of making the pattern.
std::vector<double> find_thickness(const TetMesh& mesh, const BlockPattern& neighbors, std::span<const double> moduli);

}  // namespace softreel
