/// Samples of a surface lie on it, nowhere sparser than asked for, and hold its vertices.
#include "core/tetmesh/surface_samples.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/tetmesh/triangle_tree.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

double distance_to_samples(const SurfaceSamples& samples, const Vec3& p) {
  double squared = 1e300;
  for (std::size_t s = 0; s < samples.size(); ++s) squared = std::min(squared, (samples[s] - p).squaredNorm());
  return std::sqrt(squared);
}

TEST(SurfaceSamples, LieOnTheSurfaceAndHoldItsVertices) {
  for (const double step : {0.05, 0.3, 5.0}) {
    const SurfaceMesh box = test::make_box(Vec3(0.5, 0.3, 0.2), 2, Vec3(1, 2, 3));
    const TriangleTree tree(box.positions, box.triangles);
    const SurfaceSamples samples(box, tree.order(), step);
    for (std::size_t s = 0; s < samples.size(); ++s) EXPECT_LT(tree.nearest(samples[s]).squared_distance, 1e-28) << s;
    for (const Vec3& p : box.positions) EXPECT_EQ(distance_to_samples(samples, p), 0);
  }
}

TEST(SurfaceSamples, AreNowhereFurtherApartThanAskedFor) {
  SurfaceMesh triangle;
  triangle.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.2, 0.9, 0.1)};
  triangle.triangles = {{0, 1, 2}};
  const std::vector<Vec3>& x = triangle.positions;
  constexpr double kLongest = 1.21;
  for (const double step : {0.4, 0.11, 0.035}) {
    const SurfaceSamples samples(triangle, {0}, step);
    // No small triangle of the grid has a longer edge, and none of its points is further than that / sqrt(3) away.
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; i + j <= 20; ++j)
        EXPECT_LE(distance_to_samples(samples, x[0] + i / 20.0 * (x[1] - x[0]) + j / 20.0 * (x[2] - x[0])),
                  step / std::sqrt(3.0));
    EXPECT_LT(static_cast<double>(samples.size()), 3 + (kLongest / step + 2) * (kLongest / step + 3) / 2)
        << "and no denser";
  }
}

}  // namespace
}  // namespace softreel
