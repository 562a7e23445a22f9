/// The inner product of lists of vectors.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/types.h"

namespace softreel {

/// Sum of a_i . b_i in the order of i. The lists are of one length.
inline double dot(std::span<const Vec3> a, std::span<const Vec3> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace softreel
