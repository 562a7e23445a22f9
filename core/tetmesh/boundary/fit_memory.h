/// What an earlier fit of the boundary did, for the fit of a mesh that is the same in most places.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/number_table.h"
#include "core/tetmesh/key_index.h"

namespace softreel {

/// Where nodes were before and after an earlier fit, so that a fit of a similar mesh begins there, and which face was
/// near each sample, which is where to look first.
class FitMemory {
 public:
  /// Of nodes that began at one place the first counts.
  void add(const Vec3& before, const Vec3& after);
  void reserve(std::size_t nodes) { steps_.reserve(nodes); }
  /// Where the fit took a node that began at exactly `before`; null if there was none.
  const Vec3* find(const Vec3& before) const;

  /// faces: their corners before the fit; sample_faces: per sample the number of the face that came to be near it.
  void set_sample_faces(const std::vector<std::array<Vec3, 3>>& faces, const std::vector<Index>& sample_faces);
  /// Fills in the faces that samples had, by their numbers in `faces`, corners before the fit; leaves what it does not
  /// know. Nothing if there were not as many samples.
  void find_sample_faces(const std::vector<std::array<Vec3, 3>>& faces, std::vector<Index>& sample_faces) const;

 private:
  Index find_step(const Vec3& before) const;

  NumberTable table_;
  KeyIndex face_keys_;
  std::vector<std::array<Vec3, 2>> steps_;
  std::vector<Index> sample_faces_;  ///< per sample: of face_keys_
};

}  // namespace softreel
