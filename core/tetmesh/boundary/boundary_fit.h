/// Draws the boundary of stuffed tetrahedra onto the surface, as far as the dihedral angles allow.
#pragma once

#include <memory>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/boundary/fit_memory.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"
#include "core/tetmesh/surface/surface_samples.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {

/// What a fit may do to the angles, and how long it tries.
struct BoundaryFitParams {
  double min_dihedral = 15.0;   ///< degrees; stars of nodes that are worse already only improve
  double max_dihedral = 155.0;  ///< degrees; likewise
  int sweeps = 4;               ///< each moves every boundary node at most once
  double tolerance = 0.15;      ///< spacings: what is nearer than this moves no node
  bool quick = false;           ///< of what is near enough, the first triangle met will do, not only the nearest
};

/// Where the boundary and the surface are apart.
struct BoundaryGap {
  Vec3 on_surface, on_boundary;
  Triangle face;               ///< of the boundary, at the gap; of nodes and edges too, with equal ones
  bool from_boundary = false;  ///< the point of the boundary was given, that of the surface is nearest to it
};

/// Moves boundary nodes to the nearest point of the surface; then those whose faces miss it by more than the tolerance
/// to where the largest distances round them, from the samples to the faces and from the faces to the surface, are
/// least. Elements, their order and who is neighbour of whom stay; inner nodes do not move.
///
/// No element gets a dihedral angle beyond the two of `params` unless its neighbours had a worse one before. Cost: some
/// microseconds a boundary node and sample. The bits do not depend on the number of threads.
class BoundaryFit {
 public:
  /// Fits. tree: of the surface; samples: points of it; memory: read, then replaced. All are borrowed while this lives.
  BoundaryFit(StuffedMesh& stuffed, const TriangleTree& tree, const SurfaceSamples& samples,
              const BoundaryFitParams& params, const Threads& threads, FitMemory* memory = nullptr);
  ~BoundaryFit();
  BoundaryFit(const BoundaryFit&) = delete;
  BoundaryFit& operator=(const BoundaryFit&) = delete;

  /// Samples, nodes, and middles of edges and faces that are further than `limit` (m) from the other side.
  std::vector<BoundaryGap> gaps(double limit) const;
  /// The same of three more points of each face, between its middle and its corners: no fit draws there.
  std::vector<BoundaryGap> corner_gaps(double limit) const;

 private:
  class Fit;
  std::unique_ptr<Fit> fit_;
};

/// The same with samples half a spacing apart.
void fit_boundary(StuffedMesh& stuffed, const SurfaceMesh& surface, const BoundaryFitParams& params,
                  const Threads& threads);

}  // namespace softreel
