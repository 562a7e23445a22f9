#include "core/tetmesh/surface/narrow_band.h"

#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "core/tetmesh/triangle_tree.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

std::vector<BandNode> measure(const SurfaceMesh& surface, const LatticeFrame& frame, int threads = 1) {
  return measure_narrow_band(surface.positions, surface.triangles, frame, Threads(threads));
}

/// Every node of the lattice in a box round the surface against a search of all triangles.
void expect_all_and_only_the_band(const SurfaceMesh& surface, const LatticeFrame& frame) {
  const TriangleTree tree(surface.positions, surface.triangles);
  std::map<LatticeNode, BandNode> band;
  for (const BandNode& node : measure(surface, frame)) EXPECT_TRUE(band.emplace(node.node, node).second);
  const Bounds box = used_bounds(surface);
  const Vec3 low = (box.min - frame.origin) * 2 / frame.spacing, high = (box.max - frame.origin) * 2 / frame.spacing;
  std::size_t found = 0;
  for (auto x = static_cast<int>(low[0]) - 4; x < high[0] + 4; ++x)
    for (auto y = static_cast<int>(low[1]) - 4; y < high[1] + 4; ++y)
      for (auto z = static_cast<int>(low[2]) - 4; z < high[2] + 4; ++z) {
        if (((x ^ y) & 1) != 0 || ((x ^ z) & 1) != 0) continue;
        const double distance =
            std::sqrt(tree.nearest(lattice_position(frame, {x, y, z})).squared_distance) * 2 / frame.spacing;
        const auto node = band.find({x, y, z});
        if (distance > kBandVoxels * (1 + 1e-9)) {
          EXPECT_EQ(node, band.end());
        } else if (distance < kBandVoxels * (1 - 1e-9)) {
          ASSERT_NE(node, band.end());
          EXPECT_NEAR(node->second.distance, distance, 1e-9);
          ++found;
        }
      }
  EXPECT_GT(found, 500U);
}

TEST(MeasureNarrowBand, FindsAllNodesOfFineAndOfCoarseTriangles) {
  expect_all_and_only_the_band(test::make_sphere(1, 24, Vec3(0.1, 0.2, 0.3)), {Vec3(0.01, 0.02, 0.03), 0.2});
  expect_all_and_only_the_band(test::make_box({1, 0.7, 0.03}, 1, Vec3::Zero()), {Vec3(0.01, 0.02, 0.03), 0.09});
}

TEST(MeasureNarrowBand, NamesANearestTriangle) {
  const SurfaceMesh surface = test::make_torus(1, 0.4, 24, 12, Vec3::Zero());
  const LatticeFrame frame{Vec3(0.01, 0.02, 0.03), 0.15};
  for (const BandNode& node : measure(surface, frame)) {
    const auto& [a, b, c] = surface.triangles[static_cast<std::size_t>(node.nearest)];
    const auto corner = [&](Index v) { return surface.positions[static_cast<std::size_t>(v)]; };
    const Vec3 p = lattice_position(frame, node.node);
    EXPECT_NEAR((nearest_on_triangle(p, corner(a), corner(b), corner(c)) - p).norm(), node.distance * 0.075, 1e-12);
  }
}

TEST(MeasureNarrowBand, IsTheSameFarFromTheOriginAndWithFourThreads) {
  SurfaceMesh near = test::make_torus(1, 0.4, 48, 24, Vec3::Zero());
  for (Vec3& p : near.positions) p = (p * (1 << 20)).array().round() / (1 << 20);  // far away nothing is rounded
  const Vec3 shift(1 << 20, -(1 << 19), 1 << 18);
  SurfaceMesh far = near;
  for (Vec3& p : far.positions) p += shift;
  const auto a = measure(near, {Vec3::Zero(), 0.1}, 4), b = measure(far, {shift, 0.1}),
             c = measure(near, {Vec3::Zero(), 0.1});
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(a.size(), c.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].node, b[i].node);
    EXPECT_EQ(a[i].distance, b[i].distance);
    EXPECT_EQ(a[i].distance, c[i].distance);
    EXPECT_EQ(a[i].nearest, c[i].nearest);
  }
}

TEST(MeasureNarrowBand, LeavesOutTrianglesThatAreNotFinite) {
  SurfaceMesh surface = test::make_box({1, 1, 1}, 2, Vec3::Zero());
  const std::size_t count = measure(surface, {Vec3::Zero(), 0.3}).size();
  surface.positions.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  surface.triangles.push_back({0, 1, static_cast<Index>(surface.positions.size()) - 1});
  EXPECT_EQ(measure(surface, {Vec3::Zero(), 0.3}).size(), count);
}

}  // namespace
}  // namespace softreel
