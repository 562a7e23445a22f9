/// Which samples of a surface the faces of a boundary are drawn by: those that are nearest to each.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/tetmesh/boundary/boundary_stars.h"
#include "core/tetmesh/surface/surface_samples.h"

namespace softreel {

class FaceSamples {
 public:
  /// near: squared distance below which a face stays a sample's even where another one is nearer, m^2. The references
  /// are borrowed; nodes of the mesh may move between two searches.
  FaceSamples(const TetMesh& mesh, const BoundaryStars& stars, const SurfaceSamples& samples, double near,
              const Threads& threads);

  /// Finds the face nearest to each sample, again where something moved. moved: per boundary node, since the last
  /// search; all of them before the first.
  void pair(const std::vector<bool>& moved);

  /// The face that a sample belongs to, -1 before one is known. To be given from outside before the first search only:
  /// a good guess saves it.
  std::vector<Index>& faces() { return faces_; }
  const std::vector<Index>& faces() const { return faces_; }

  /// Between a sample and its face, m^2.
  double squared_distance(std::size_t sample) const { return squared_[sample]; }
  /// Between any point and any face, m^2.
  double squared_distance(const Vec3& p, Index face) const;

  /// Samples that a face is drawn by: some of its own, the farthest among them; none that is out of reach.
  std::span<const Index> of(Index face) const { return lists_.of(static_cast<std::size_t>(face)); }

 private:
  bool has_moved(Index face, const std::vector<bool>& moved) const;
  void list();
  double squared_reach(std::size_t face) const;

  const TetMesh& mesh_;
  const BoundaryStars& stars_;
  const SurfaceSamples& samples_;
  double near_;
  const Threads& threads_;
  std::vector<Index> faces_;
  std::vector<double> squared_;
  CompressedList lists_;
};

}  // namespace softreel
