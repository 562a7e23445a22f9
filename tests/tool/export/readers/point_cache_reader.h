/// Readers of PC2 and MDD point caches for tests, written from the descriptions of the formats.
#pragma once

#include <string>
#include <vector>

namespace softreel::testing {

struct PointCache {
  int points = 0;
  float start_frame = 0, frames_apart = 0;  ///< PC2
  std::vector<float> times;                 ///< MDD: seconds
  std::vector<std::vector<float>> samples;  ///< x, y, z of every point
};

/// Throw std::runtime_error where the bytes are none of the format, or too few or too many.
PointCache read_pc2(const std::string& bytes);
PointCache read_mdd(const std::string& bytes);

}  // namespace softreel::testing
