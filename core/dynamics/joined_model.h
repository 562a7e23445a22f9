/// Several bodies as one model of a simulator, so that glue between them is solved with them, not after them.
#pragma once

#include <vector>

#include "core/dynamics/simulator.h"

namespace softreel {

/// Where one body's entries begin in a joined model.
struct ModelOffsets {
  Index node = 0, tet = 0, point = 0;
};
std::vector<ModelOffsets> find_offsets(const std::vector<BodyModel>& models);

/// Nodes, elements, surface points, materials, pins and pulls one after the other; the name is "a + b", gravity that of
/// the first. Glues are left to the caller: their numbers are those of the joined model. At least one model.
BodyModel join_models(const std::vector<BodyModel>& models);

/// Spacing of the lattice that a mesh was cut from, m; of one made elsewhere, of a lattice with tetrahedra of its mean
/// volume, 12 to a cube.
double spacing_of(const TetMesh& mesh);

/// One body's part of a joined state: `nodes` and `tets` entries from these offsets on. Bonds stay with the whole.
SimulationState part_of(const SimulationState& joined, const ModelOffsets& from, std::size_t nodes, std::size_t tets);

}  // namespace softreel
