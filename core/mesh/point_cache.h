/// A point cache: the places of all vertices of a mesh at a row of times.
#pragma once

#include "core/mesh/animated_vertices.h"

namespace softreel {

struct PointCache {
  Index points = 0;
  std::vector<double> seconds;   ///< per sample, rising, the first is 0
  std::vector<Vec3f> positions;  ///< samples x points, in the file's axes and unit
};

/// Straight lines between samples.
class CachedVertices : public AnimatedVertices {
 public:
  explicit CachedVertices(PointCache cache);

  Index count() const override { return cache_.points; }
  std::vector<Vec3> at(double seconds, std::span<const Index> vertices) const override;
  std::vector<Vec3> rest() const override;
  std::vector<double> pose(double seconds) const override;
  std::uint64_t content() const override { return 0; }  // the pose is all there is

 private:
  struct Place {
    std::size_t sample = 0;
    double share = 0;  ///< of the way to the next sample
  };
  Place place(double seconds) const;
  Vec3 position(std::size_t sample, Index vertex) const;

  PointCache cache_;
  std::vector<std::array<double, 2>> prints_;  ///< per sample
};

}  // namespace softreel
