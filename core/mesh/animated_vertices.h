/// Vertices that a file moves in time: of skinned and morphed meshes, of point caches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// Positions are in the file's own axes and unit; times before the first and after the last sample hold those.
class AnimatedVertices {
 public:
  virtual ~AnimatedVertices() = default;

  virtual Index count() const = 0;
  /// Where some of the vertices are. Thread-safe.
  virtual std::vector<Vec3> at(double seconds, std::span<const Index> vertices) const = 0;
  /// Where all are at rest: in the pose that the file shows without its clips; of a point cache, in its first sample.
  virtual std::vector<Vec3> rest() const = 0;
  /// Numbers that are equal at two times only if all vertices are at the same places: what keys of results hash.
  virtual std::vector<double> pose(double seconds) const = 0;
  /// Of all that shapes the vertices beside the pose.
  virtual std::uint64_t content() const = 0;
};

}  // namespace softreel
