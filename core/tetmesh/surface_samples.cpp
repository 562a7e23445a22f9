#include "core/tetmesh/surface_samples.h"

#include <algorithm>
#include <cmath>

#include "core/tetmesh/key_index.h"

namespace softreel {
namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

std::vector<Vec3> sample_surface(const SurfaceMesh& surface, const std::vector<Index>& order, double step) {
  std::vector<Vec3> samples;
  std::vector<bool> taken(surface.positions.size(), false);
  for (const Index t : order) {
    const Triangle& triangle = surface.triangles[at(t)];
    std::array<Vec3, 3> x;
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = surface.positions[at(triangle[k])];
      if (!taken[at(triangle[k])]) samples.push_back(x[k]);
      taken[at(triangle[k])] = true;
      longest = std::max(longest, (x[k] - surface.positions[at(triangle[(k + 1) % 3])]).norm());
    }
    const int n = static_cast<int>(std::ceil(longest / step));
    for (int i = 0; i <= n && n > 1; ++i)
      for (int j = 0; i + j <= n; ++j)
        samples.emplace_back(x[0] + (static_cast<double>(i) / n) * (x[1] - x[0]) +
                             (static_cast<double>(j) / n) * (x[2] - x[0]));
  }
  return samples;
}

std::vector<Vec3> sample_surface_once(const SurfaceMesh& surface, const std::vector<Index>& order, double step) {
  std::vector<Vec3> samples;
  std::vector<bool> taken(surface.positions.size(), false);
  KeyIndex edges;
  for (const Index t : order) {
    const Triangle& triangle = surface.triangles[at(t)];
    std::array<Vec3, 3> x;
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = surface.positions[at(triangle[k])];
      if (!taken[at(triangle[k])]) samples.push_back(x[k]);
      taken[at(triangle[k])] = true;
      longest = std::max(longest, (x[k] - surface.positions[at(triangle[(k + 1) % 3])]).norm());
    }
    const int n = static_cast<int>(std::ceil(longest / step));
    for (std::size_t k = 0; k < 3 && n > 1; ++k) {
      const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
      if (!edges.insert(static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high)).second) continue;
      for (int i = 1; i < n; ++i) samples.emplace_back(x[k] + (static_cast<double>(i) / n) * (x[(k + 1) % 3] - x[k]));
    }
    for (int i = 1; i < n; ++i)
      for (int j = 1; i + j < n; ++j)
        samples.emplace_back(x[0] + (static_cast<double>(i) / n) * (x[1] - x[0]) +
                             (static_cast<double>(j) / n) * (x[2] - x[0]));
  }
  return samples;
}

}  // namespace softreel
