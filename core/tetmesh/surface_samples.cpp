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
  const auto parts = [&](double length) { return static_cast<int>(std::ceil(length / step)); };
  for (const Index t : order) {
    const Triangle& triangle = surface.triangles[at(t)];
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index i = std::min(triangle[k], triangle[(k + 1) % 3]), j = std::max(triangle[k], triangle[(k + 1) % 3]);
      if (!taken[at(triangle[k])]) samples.push_back(surface.positions[at(triangle[k])]);
      taken[at(triangle[k])] = true;
      const Vec3 &from = surface.positions[at(i)], along = surface.positions[at(j)] - from;
      const double length = along.norm();
      longest = std::max(longest, length);
      if (parts(length) < 2 ||
          !edges.insert(static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint64_t>(j)).second)
        continue;
      for (int part = 1; part < parts(length); ++part)
        samples.emplace_back(from + (static_cast<double>(part) / parts(length)) * along);
    }
    const int n = parts(longest);
    const Vec3& corner = surface.positions[at(triangle[0])];
    const Vec3 u = (surface.positions[at(triangle[1])] - corner) / n,
               v = (surface.positions[at(triangle[2])] - corner) / n;
    for (int i = 1; i < n; ++i)
      for (int j = 1; i + j < n; ++j) samples.emplace_back(corner + i * u + j * v);
  }
  return samples;
}

std::size_t put_coarse_first(std::vector<Vec3>& points, double width) {
  KeyIndex cubes;
  const auto takes_cube = [&](const Vec3& p) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key = key * 0x100001b3ULL + static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(p[k] / width)));
    return cubes.insert(key).second;  // two cubes of one key, which are rare, share a point
  };
  std::vector<Vec3> rest;
  std::size_t coarse = 0;
  for (const Vec3& p : points)
    if (takes_cube(p))
      points[coarse++] = Vec3(p);
    else
      rest.push_back(p);
  std::copy(rest.begin(), rest.end(), points.begin() + static_cast<std::ptrdiff_t>(coarse));
  return coarse;
}

}  // namespace softreel
