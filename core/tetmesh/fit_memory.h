/// What an earlier fit of the boundary did, for the fit of a mesh that is the same in most places.
#pragma once

#include <array>
#include <vector>

#include "core/tetmesh/key_index.h"

namespace softreel {

/// Where nodes were before and after an earlier fit, so that a fit of a similar mesh begins there.
class FitMemory {
 public:
  void add(const Vec3& before, const Vec3& after);
  /// Where the fit took a node that began at exactly `before`; null if there was none.
  const Vec3* find(const Vec3& before) const;

 private:
  KeyIndex keys_;
  std::vector<std::array<Vec3, 2>> steps_;
};

}  // namespace softreel
