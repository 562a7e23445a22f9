/// A surface as all graded fillings of it see it: its distances, what of it there is to follow, where a filling misses
/// it.
#pragma once

#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/boundary/boundary_fit.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"
#include "core/tetmesh/surface/hole_caps.h"
#include "core/tetmesh/surface/signed_distance.h"
#include "core/tetmesh/surface/surface_samples.h"

namespace softreel {

/// Which pieces of a filling ought to hang together with another.
struct LooseRule {
  double most_share;                          ///< of the elements; larger ones are let be
  const std::vector<Index>& triangle_solids;  ///< as of find_main_pieces
};

/// Borrows the surface. Reading is thread-safe.
class FilledSurface {
 public:
  explicit FilledSurface(const SurfaceMesh& mesh);

  const SurfaceMesh& surface() const { return surface_; }
  const DistanceSampler& sampler() const { return sampler_; }
  const TriangleTree& tree() const { return sampler_.tree(); }
  const Bounds& box() const { return box_; }
  double area() const;  ///< m^2

  /// What a boundary has to follow to within `error`, positions and triangles: the surface as it is, unless it overlaps
  /// itself.
  SurfaceMesh visible(double error, const Threads& threads) const;
  /// Points of it, at most `step` apart on large triangles, each once. Borrows `visible`.
  SurfaceSamples sample(const SurfaceMesh& visible, double step) const;

  /// No size brings the cap of a hole nearer to the surface.
  void leave_out_caps(std::vector<BoundaryGap>& gaps) const;

  /// All places where the boundary and what is visible are further apart than `limit`, m, also inside faces. Caps of
  /// holes do not count.
  std::vector<BoundaryGap> find_gaps(const StuffedMesh& stuffed, const SurfaceMesh& visible, double limit,
                                     const Threads& threads) const;

  /// The boundary faces of pieces of at most a share of the elements, beside the main ones (find_main_pieces): these
  /// hang by necks that are thinner than the tetrahedra, and are gaps as wide as they are.
  std::vector<BoundaryGap> find_loose_pieces(const StuffedMesh& stuffed, const std::vector<Index>& nearest_triangles,
                                             const LooseRule& rule) const;

 private:
  SurfaceMesh without_caps(const std::vector<Vec3>& nodes, const std::vector<Triangle>& faces, double limit,
                           const Threads& threads) const;

  const SurfaceMesh& surface_;
  DistanceSampler sampler_;
  HoleCaps caps_;
  Bounds box_;
};

}  // namespace softreel
