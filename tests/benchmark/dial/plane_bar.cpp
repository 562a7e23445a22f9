#include "tests/benchmark/dial/plane_bar.h"

#include <algorithm>
#include <cmath>

#include "core/skinning/embedding.h"
#include "tests/support/bcc_bar.h"

namespace softreel::bench {
namespace {

/// Where the bar is cut along x, its ends among them, in order. m
std::vector<double> planes_of(const SurfaceMesh& surface, const BodyConstraints& constraints, const Bounds& bounds) {
  constexpr double kBeyond = 1e-6;  // m: the last pinned vertices lie on one side for certain
  std::vector<double> planes{bounds.min.x(), bounds.max.x()};
  for (const Pin& pin : constraints.pins) {
    double low = bounds.max.x(), high = bounds.min.x();
    for (const Index point : pin.points) {
      const double x = surface.positions[static_cast<std::size_t>(point)].x();
      low = std::min(low, x);
      high = std::max(high, x);
    }
    planes.push_back(low <= bounds.min.x() ? high + kBeyond : low - kBeyond);
  }
  std::sort(planes.begin(), planes.end());
  return planes;
}

/// Node planes of the cells, of nearly equal distances in each part.
std::vector<double> cut_parts(const std::vector<double>& planes, double edge) {
  std::vector<double> cuts{planes.front()};
  for (std::size_t p = 1; p < planes.size(); ++p) {
    const double length = planes[p] - planes[p - 1];
    const int cells = std::max(1, static_cast<int>(std::lround(length / edge)));
    for (int i = 1; i <= cells; ++i) cuts.push_back(planes[p - 1] + length * i / cells);
  }
  return cuts;
}

}  // namespace

FilledBody fill_to_planes(const SurfaceMesh& surface, const BodyConstraints& constraints, int across) {
  const Bounds bounds = used_bounds(surface);
  const Vec3 size = bounds.max - bounds.min;
  const std::vector<double> cuts = cut_parts(planes_of(surface, constraints, bounds), size.y() / across);
  const int along = static_cast<int>(cuts.size()) - 1;
  FilledBody filled;
  filled.mesh = testing::kuhn_bar({along, across, across}, Vec3(along, size.y(), size.z()));
  for (Vec3& node : filled.mesh.nodes) {
    const double x = cuts[static_cast<std::size_t>(std::lround(node.x()))];
    node = Vec3(x, bounds.min.y() + node.y(), bounds.min.z() + node.z());
  }
  filled.mesh.lattice = {bounds.min, size.y() / across};
  filled.normals = vertex_normals(surface, surface.positions);
  filled.embedding = embed_points(surface.positions, filled.normals, filled.mesh, Threads(1));
  return filled;
}

}  // namespace softreel::bench
