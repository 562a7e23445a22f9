#include "core/tetmesh/filling/solids.h"

#include <ctime>

#include <gtest/gtest.h>

#include "tests/support/surfaces.h"

namespace softreel {
namespace {

using test::joined;
using test::make_box;
using test::make_sphere;

SurfaceMesh inside_out(SurfaceMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

std::vector<Index> solids_of(const std::vector<SurfaceMesh>& parts) {
  const SurfaceMesh all = joined(parts);
  return find_solids(all, find_parts(all));
}

SurfaceMesh ball(double radius, const Vec3& center = Vec3::Zero()) {
  return make_sphere(radius, 12, center);
}

TEST(FindSolids, KeepsApartWhatOnlyComesNear) {
  EXPECT_EQ(solids_of({ball(1), ball(1, Vec3(2.001, 0, 0))}), (std::vector<Index>{0, 1}));
  // Two interlocked rods, boxes overlapping, surfaces not.
  EXPECT_EQ(solids_of({make_box(Vec3(1, 0.1, 0.1), 1, Vec3::Zero()), make_box(Vec3(0.1, 1, 0.1), 1, Vec3(0, 0, 0.21))}),
            (std::vector<Index>{0, 1}));
}

TEST(FindSolids, JoinsWhatCrosses) {
  EXPECT_EQ(solids_of({ball(1), ball(1, Vec3(1.5, 0.1, 0.2)), ball(0.5, Vec3(0, 5, 0))}),
            (std::vector<Index>{0, 0, 1}));
  // A rod through a plate: no corner of either is inside the other.
  EXPECT_EQ(solids_of({make_box(Vec3(1, 1, 0.05), 1, Vec3::Zero()), make_box(Vec3(0.1, 0.12, 1), 1, Vec3(0.3, 0, 0))}),
            (std::vector<Index>{0, 0}));
}

TEST(FindSolids, TellsOverlapFromTouchWhereFacesLieInOnePlane) {
  const SurfaceMesh cube = make_box(Vec3(1, 1, 1), 3, Vec3::Zero());
  EXPECT_EQ(solids_of({cube, make_box(Vec3(1, 1, 1), 2, Vec3(0.97, 0, 0))}), (std::vector<Index>{0, 0}));
  EXPECT_EQ(solids_of({cube, make_box(Vec3(1, 1, 1), 4, Vec3(0, 1.45, 0))}), (std::vector<Index>{0, 0}));
  EXPECT_EQ(solids_of({cube, make_box(Vec3(0.7, 0.7, 0.7), 2, Vec3(1.7, 0, 0))}), (std::vector<Index>{0, 1}));
  EXPECT_EQ(solids_of({cube, make_box(Vec3(0.7, 0.7, 0.7), 2, Vec3(-1.7, 0, 0))}), (std::vector<Index>{0, 1}));
}

TEST(FindSolids, GivesCavitiesAndHiddenShellsToTheMaterialAroundThem) {
  EXPECT_EQ(solids_of({ball(2), inside_out(ball(1))}), (std::vector<Index>{0, 0}));
  EXPECT_EQ(solids_of({ball(2), ball(1)}), (std::vector<Index>{0, 0}));
  // A ball in a cavity is a body of its own, and so is what is hidden in it.
  EXPECT_EQ(solids_of({ball(3), inside_out(ball(2)), ball(1), ball(0.5)}), (std::vector<Index>{0, 0, 1, 1}));
  // A surface that is inside out as a whole says the same.
  EXPECT_EQ(solids_of({inside_out(ball(3)), ball(2), inside_out(ball(1))}), (std::vector<Index>{0, 0, 1}));
}

TEST(FindSolids, KeepsOpenPartsWithWhatIsNearThem) {
  SurfaceMesh pot = make_box(Vec3(1, 1, 1), 4, Vec3::Zero()), lid;
  lid.positions = pot.positions;
  const auto is_top = [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(),
                       [&](Index v) { return pot.positions[static_cast<std::size_t>(v)].y() > 1 - 1e-9; });
  };
  std::copy_if(pot.triangles.begin(), pot.triangles.end(), std::back_inserter(lid.triangles), is_top);
  std::erase_if(pot.triangles, is_top);
  for (Vec3& p : lid.positions) p.y() += 0.05;
  EXPECT_EQ(solids_of({pot, lid, ball(0.2, Vec3(5, 0, 0))}), (std::vector<Index>{0, 0, 1}));
}

TEST(CountSolids, JoinsShellsThatOverlapAndNoneThatTouch) {
  const SurfaceMesh cube = make_box(Vec3(1, 1, 1), 2, Vec3::Zero());
  EXPECT_EQ(count_solids(joined({ball(1), make_box(Vec3(1, 0.02, 0.02), 1, Vec3(1.5, 0, 0))})), 1);
  EXPECT_EQ(count_solids(joined({cube, make_box(Vec3(1, 1, 1), 2, Vec3(2, 2, 0))})), 2);  // at an edge
  EXPECT_EQ(count_solids(joined({cube, make_box(Vec3(1, 1, 1), 2, Vec3(2, 2, 2))})), 2);  // at a corner
  EXPECT_EQ(count_solids(joined({ball(2), inside_out(ball(1))})), 1);
}

TEST(FindTriangleSolids, TellsApartWhatTouches) {
  const SurfaceMesh cube = make_box(Vec3(1, 1, 1), 1, Vec3::Zero());
  const SurfaceMesh rod = make_box(Vec3(1, 0.02, 0.02), 1, Vec3(1.5, 0, 0));
  std::vector<Index> wanted(36, 0);
  std::fill(wanted.begin() + 12, wanted.begin() + 24, 1);
  EXPECT_EQ(find_triangle_solids(joined({cube, make_box(Vec3(1, 1, 1), 1, Vec3(2, 2, 0)), rod})), wanted);
}

/// Seconds of the processor: other processes do not count.
template <typename Work>
double seconds_of(const Work& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// All pairs of boxes overlap, no triangles do. Each pair looked at in full took half a millisecond, which is 150 times
/// what finding the parts ten times takes; a seventh of that does.
TEST(FindSolids, TakesNoTimeForShellsWithinShells) {
  std::vector<SurfaceMesh> shells;
  for (int k = 0; k < 200; ++k) shells.push_back(make_sphere(1 + 0.01 * k, 5, Vec3::Zero()));
  const SurfaceMesh all = joined(shells);
  const SurfaceParts parts = find_parts(all);
  std::vector<Index> solids;
  const double time = seconds_of([&] { solids = find_solids(all, parts); });
  const double unit = seconds_of([&] {
    for (int k = 0; k < 10; ++k) EXPECT_EQ(find_parts(all).parts.size(), shells.size());
  });
  EXPECT_LT(time, 60 * unit);
  EXPECT_EQ(solids, std::vector<Index>(200, 0));
}

TEST(SplitSolids, HandsEveryTriangleToItsSolid) {
  const SurfaceMesh all = joined({ball(1), ball(1, Vec3(3, 0, 0)), inside_out(ball(0.5))});
  const SurfaceParts parts = find_parts(all);
  const std::vector<Solid> solids = split_solids(all, parts, find_solids(all, parts));
  ASSERT_EQ(solids.size(), 2u);
  EXPECT_EQ(solids[0].surface.triangles.size() + solids[1].surface.triangles.size(), all.triangles.size());
  ASSERT_EQ(solids[0].parts.parts.size(), 2u);
  EXPECT_EQ(solids[0].parts.parts[1].name, parts.parts[2].name);
  EXPECT_NEAR(solids[0].parts.volume() + solids[1].parts.volume(), parts.volume(), 1e-12);
  for (const Solid& solid : solids) {
    EXPECT_EQ(solid.parts.triangle_parts.size(), solid.surface.triangles.size());
    const SurfaceParts again = find_parts(solid.surface);
    EXPECT_EQ(again.parts.size(), solid.parts.parts.size());
    EXPECT_NEAR(again.volume(), solid.parts.volume(), 1e-12);
  }
}

}  // namespace
}  // namespace softreel
