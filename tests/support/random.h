/// Random vectors, matrices and rotations, normally distributed, so that no direction is preferred.
#pragma once

#include <random>

#include "core/base/types.h"

namespace softreel::test_support {

using Random = std::mt19937_64;

inline Vec3 random_vector(Random& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

inline Mat3 random_matrix(Random& random) {
  Mat3 A;
  for (int k = 0; k < 3; ++k) A.col(k) = random_vector(random);
  return A;
}

inline Quaternion random_rotation(Random& random) {
  std::normal_distribution<double> normal;
  return Quaternion(normal(random), normal(random), normal(random), normal(random)).normalized();
}

}  // namespace softreel::test_support
