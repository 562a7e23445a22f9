/// What an earlier fit of the boundary did, for the fit of a mesh that is the same in most places.
#pragma once

#include <array>
#include <vector>

#include "core/tetmesh/number_table.h"

namespace softreel {

/// Where nodes were before and after an earlier fit, so that a fit of a similar mesh begins there.
class FitMemory {
 public:
  /// Of nodes that began at one place the first counts.
  void add(const Vec3& before, const Vec3& after);
  void reserve(std::size_t nodes) { steps_.reserve(nodes); }
  /// Where the fit took a node that began at exactly `before`; null if there was none.
  const Vec3* find(const Vec3& before) const;

 private:
  Index find_step(const Vec3& before) const;

  NumberTable table_;
  std::vector<std::array<Vec3, 2>> steps_;
};

}  // namespace softreel
