/// Samples of a surface lie on it, nowhere sparser than asked for, and hold its vertices.
#include "core/tetmesh/surface/surface_samples.h"

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

TEST(SurfaceSamples, OnceAreTheSamePlacesEachOnce) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  // All edges of a face are of equal length: neighbours have as many steps.
  SurfaceMesh tetrahedron;
  tetrahedron.positions = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)};
  tetrahedron.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  // Steps of 2 / 2^k: the places have no round-off.
  for (const double step : {3.0, 1.5, 0.75, 0.36}) {
    const SurfaceSamples each(tetrahedron, {0, 1, 2, 3}, step),
        once(tetrahedron, {0, 1, 2, 3}, step, SurfaceSamples::kOnce);
    std::vector<Vec3> places, single;
    for (std::size_t s = 0; s < each.size(); ++s) places.push_back(each[s]);
    for (std::size_t s = 0; s < once.size(); ++s) single.push_back(once[s]);
    std::sort(places.begin(), places.end(), less);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    std::sort(single.begin(), single.end(), less);
    EXPECT_EQ(single, places) << step;
  }
}

TEST(SurfaceSamples, ThinnedAreEveryNthOfThem) {
  const SurfaceMesh box = test::make_box(Vec3(0.5, 0.3, 0.2), 2, Vec3(1, 2, 3));
  const SurfaceSamples all(box, TriangleTree(box.positions, box.triangles).order(), 0.1);
  const SurfaceSamples some = all.thinned(3);
  ASSERT_EQ(some.size(), (all.size() + 2) / 3);
  for (std::size_t s = 0; s < some.size(); ++s) EXPECT_EQ(some[s], all[3 * s]);
}

}  // namespace
}  // namespace softreel
