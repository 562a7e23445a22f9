#include "core/tetmesh/improvement/triangle_samples.h"

#include <algorithm>
#include <cmath>

namespace softreel {
namespace {

/// Points of the grid that are no corners.
void append_grid(const std::array<Vec3, 3>& x, double step, std::vector<Vec3>& samples) {
  const Vec3 u = x[1] - x[0], v = x[2] - x[0];
  const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
  const int n = static_cast<int>(std::ceil(longest / step));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      if ((i != 0 || j != 0) && i != n && j != n)
        samples.push_back(x[0] + (static_cast<double>(i) / n) * u + (static_cast<double>(j) / n) * v);
}

}  // namespace

std::vector<Vec3> sample_triangles(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                                   double step) {
  std::vector<Vec3> samples;
  std::vector<bool> taken(points.size(), false);
  for (const Triangle& triangle : triangles) {
    std::array<Vec3, 3> x;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(triangle[k]);
      x[k] = points[v];
      if (!taken[v]) samples.push_back(points[v]);
      taken[v] = true;
    }
    append_grid(x, step, samples);
  }
  return samples;
}

}  // namespace softreel
