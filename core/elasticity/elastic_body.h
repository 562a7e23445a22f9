/// All elements of a body at once: rotations, forces and energy of a deformed state.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/elasticity/element.h"
#include "core/elasticity/element_lanes.h"
#include "core/elasticity/material.h"
#include "core/elasticity/node_sums.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// How the element rotation is extracted (design 4.2). Stored results are keyed by the numbers: new methods go last.
enum class RotationMethod {
  Consistent,   ///< nearest to F: the force is the exact gradient of a continuous energy
  Energy,       ///< nearest to F S: the paper's eq. (3), safeguarded
  None,         ///< small strain: Q = I
  Paper,        ///< eq. (3) by the paper's bare Newton, eqs. (5)-(8)
  PolarSmooth,  ///< averages of the consistent ones over neighbours (sec. 5)
  Qr            ///< Gram-Schmidt of F; depends on the order of nodes
};

/// True if the force is the gradient of elastic_energy at the method's rotations.
constexpr bool has_energy(RotationMethod method) {
  return method == RotationMethod::Consistent || method == RotationMethod::None;
}

/// How the dilatation stress grows (design 4.3).
enum class Dilatation { Capped, Linear };

/// The elements that have a node, for gathering: those of node i are entries [offsets[i], offsets[i + 1]), ascending;
/// each entry is 4 * element + position of the node in it.
struct NodeElements {
  std::vector<std::int64_t> offsets;
  std::vector<std::uint32_t> entries;
};

NodeElements gather_node_elements(const std::vector<Tet>& tets, Index nodes);

/// Rest shapes and laws of the elements; immutable during a run.
struct ElasticBody {
  std::vector<Vec3> rest_positions;  ///< X, nodes x 3, m
  std::vector<Tet> tets;
  std::vector<ElementShape> shapes;   ///< per element
  std::vector<ElasticLaw> laws;       ///< per element
  std::vector<ElementBatch> batches;  ///< shapes and laws again, in lanes
  NodeElements node_elements;
  NodeSlabs node_slabs;
};

/// The mesh with its materials (one per element). Volumes must be positive.
ElasticBody make_elastic_body(const TetMesh& mesh, const std::vector<ElementMaterial>& materials,
                              Dilatation dilatation);

/// Nodes of element e.
inline TetNodes nodes_of(const Tet& tet, std::span<const Vec3> positions) {
  const auto at = [&](std::size_t k) { return positions[static_cast<std::size_t>(tet[k])]; };
  return {at(0), at(1), at(2), at(3)};
}

/// Extracts every element's rotation at `positions` (stage "rotate"). rotations: guesses in, results out.
void find_rotations(const ElasticBody& body, RotationMethod method, std::span<const Vec3> positions,
                    std::span<Quaternion> rotations, const Threads& threads);

/// find_rotations; returns how many elements have det F below kFlatVolume. The consistent method has that at hand, the
/// others look in a pass of their own.
std::int64_t find_rotations_and_flat(const ElasticBody& body, RotationMethod method, std::span<const Vec3> positions,
                                     std::span<Quaternion> rotations, const Threads& threads);

/// Weighted first Piola stress V Q sigma of each element, N m.
void find_stresses(const ElasticBody& body, std::span<const Vec3> positions, std::span<const Quaternion> rotations,
                   std::span<Mat3> stresses, const Threads& threads);

/// Elastic forces on the nodes, -sum over their elements of stress * b_i, N: minus the gradient of elastic_energy where
/// the rotations are the consistent ones. They sum to zero. Gathered per node, in the order of elements.
void gather_forces(const ElasticBody& body, std::span<const Mat3> stresses, std::span<Vec3> forces,
                   const Threads& threads);

/// Sum of V times the energy density over all elements, J.
double elastic_energy(const ElasticBody& body, std::span<const Vec3> positions, std::span<const Quaternion> rotations,
                      const Threads& threads);

}  // namespace softreel
