/// Keeps what is thinner than the lattice in one piece: limbs, tails and sheets between whose nodes the surface slips.
#pragma once

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/surface/signed_distance.h"
#include "core/tetmesh/surface/surface_parts.h"

namespace softreel {

/// Moves lattice nodes inside where the lattice would lose a stretch of the surface, or would let one part of it fall
/// into pieces: there the body gets about one lattice edge thick. Returns the number of such nodes; 0 leaves `distance`
/// as it was. A part of the surface without any firm inside node is left alone: it is lost as a whole.
///
/// A node counts as inside only if stuffing will not warp it onto the surface. Where the surface is further from such a
/// node than kLostReach spacings, or where neighbouring points of a triangle have nodes that do not hang together, all
/// nodes within kFillReach of points just under the surface there are taken in. That is more than the covering radius
/// of the lattice (sqrt(5)/4 of the spacing) and less than half of 1.3, so the nodes along any path on the surface are
/// neighbours in turn, and what is joined by lattice edges is joined through faces of tetrahedra.
Index bridge_thin_parts(SurfaceDistance& distance, const SurfaceMesh& surface, const SurfaceParts& parts);

}  // namespace softreel
