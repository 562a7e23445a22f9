/// Points of the surface and the faces of a moving boundary that are nearest to them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/tetmesh/boundary_stars.h"
#include "core/tetmesh/fit_memory.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// All arguments are borrowed.
class SamplePairing {
 public:
  /// near: squared, m^2; of faces nearer to a sample than that any will do.
  SamplePairing(std::span<const Vec3> samples, const BoundaryStars& stars, const TetMesh& mesh, double near);

  /// Takes over what an earlier fit, to samples that begin with the same ones, found at the same faces. It stands for
  /// those that do not move.
  void recall(const FitMemory& memory, const Recollection& known);

  /// Finds the nearest faces again where something moved. moved: per boundary node. Returns per face whether it won or
  /// lost samples.
  std::vector<std::uint8_t> update(const std::vector<std::uint8_t>& moved, const Threads& threads);

  /// Samples that a face is drawn by: the farthest one within reach and about kFaceSamples others.
  std::span<const Index> of_face(Index face) const { return face_samples_.of(static_cast<std::size_t>(face)); }
  const Vec3& point(Index sample) const { return samples_[static_cast<std::size_t>(sample)]; }
  /// Squared distance to the nearest face, m^2, at the last update.
  double squared(Index sample) const { return near_faces_[static_cast<std::size_t>(sample)].squared; }
  /// Per sample.
  const std::vector<NearTriangle>& near_faces() const { return near_faces_; }

  double squared_distance(const Vec3& p, Index face) const;

 private:
  bool has_moved(Index face, const std::vector<std::uint8_t>& moved) const;
  void list_samples();

  std::span<const Vec3> samples_;
  const BoundaryStars& stars_;
  const TetMesh& mesh_;
  double near_;
  std::vector<NearTriangle> near_faces_;
  CompressedList face_samples_;
};

}  // namespace softreel
