/// Carries the deformation of the tetrahedra to the surface points embedded in them.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"
#include "core/skinning/embedding.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Deformed positions of the points: rest point + weighted displacement of the element's nodes, so that the rest pose
/// is reproduced exactly. A point that its weights do not give, as it is too far outside, keeps its offset from the
/// point that they give, turned with the element. Pins and pulls see that point of the element's affine motion: the
/// same as long as the element is not strained. node_positions: deformed, as mesh.nodes.
std::vector<Vec3> skin_positions(const std::vector<Vec3>& rest_points, const Embedding& embedding, const TetMesh& mesh,
                                 const std::vector<Vec3>& node_positions, const Threads& threads);

/// Deformed unit normals: cofactor of the deformation gradient times the rest normal. The gradient is averaged to the
/// nodes by volume and interpolated, so that shading is smooth across elements. points: of the embedding, per normal
/// the one that it is at, where a point may have several normals or none; empty: one each, in their order.
std::vector<Vec3> skin_normals(const std::vector<Vec3>& rest_normals, const Embedding& embedding, const TetMesh& mesh,
                               const std::vector<Vec3>& node_positions, const Threads& threads,
                               std::span<const Index> points = {});

/// A quantity of the elements at the points: averaged to the nodes by volume of material, then interpolated; where a
/// point lies outside of its element, not beyond the values of the element's nodes. element_values: as mesh.tets.
std::vector<double> skin_values(const std::vector<double>& element_values, const Embedding& embedding,
                                const TetMesh& mesh, const Threads& threads);

}  // namespace softreel
