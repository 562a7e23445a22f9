/// Solids that touch without overlapping are found however they lie, and said.
#include "core/tetmesh/filling/touching_solids.h"

#include <gtest/gtest.h>

#include "core/tetmesh/filling/tetrahedralize.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

using Pairs = std::vector<std::array<Index, 2>>;
using test::joined;
using test::make_box;

Pairs touching_of(const SurfaceMesh& surface) {
  const SurfaceParts parts = find_parts(surface);
  return find_touching(split_solids(surface, parts, find_solids(surface, parts)));
}

/// A slab, and legs whose tops lie in its lower face.
std::vector<SurfaceMesh> table(double gap) {
  std::vector<SurfaceMesh> parts{make_box(Vec3(1, 0.1, 1), 3, Vec3(0, 1.1, 0))};
  for (const double x : {-0.8, 0.8})
    for (const double z : {-0.8, 0.8}) parts.push_back(make_box(Vec3(0.1, 0.5, 0.1), 1, Vec3(x, 0.5 - gap, z)));
  return parts;
}

TEST(FindTouching, FindsFlushFacesHoweverTheyLie) {
  const Pairs legs{{0, 1}, {0, 2}, {0, 3}, {0, 4}};
  for (const double degrees : {0, 17, 45, 90, 133}) {
    SurfaceMesh surface = joined(table(0));
    const Mat3 turn = Eigen::AngleAxisd(degrees * M_PI / 180, Vec3(0.3, 1, -0.6).normalized()).toRotationMatrix();
    for (Vec3& x : surface.positions) x = turn * x + Vec3(3, -7, 11);
    EXPECT_EQ(touching_of(surface), legs) << degrees;
  }
}

TEST(FindTouching, FindsFacesThatMeetInNoVertexAndNoMiddle) {
  EXPECT_EQ(touching_of(joined(
                {make_box(Vec3(5, 0.1, 0.1), 1, Vec3::Zero()), make_box(Vec3(0.1, 0.1, 5), 1, Vec3(0, 0.2, 0))})),
            (Pairs{{0, 1}}));
}

TEST(FindTouching, LeavesOutWhatIsApartAndWhatIsOne) {
  EXPECT_EQ(touching_of(joined(table(1e-3))), Pairs{});
  EXPECT_EQ(touching_of(joined(table(-0.02))), Pairs{}) << "the legs reach into the slab";
  EXPECT_EQ(touching_of(make_box(Vec3(1, 1, 1), 2, Vec3::Zero())), Pairs{});
}

TEST(FindTouching, TakesGapsOfRoundOffForNone) {
  EXPECT_EQ(touching_of(joined(table(1e-6))).size(), 4u);
}

TEST(WarnOfTouching, InEveryMode) {
  for (const TetMode mode : {TetMode::Conforming, TetMode::Embedded})
    for (const double gap : {0.0, 1e-3}) {
      std::string warned;
      StageTimes times;
      tetrahedralize(joined(table(gap)), {.tets = 8000, .mode = mode}, "table", Threads(1),
                     {[](const std::string&) {}, [&](const std::string& line) { warned += line; }}, times);
      EXPECT_EQ(warned.find("touch") != std::string::npos, gap == 0) << warned;
    }
}

}  // namespace
}  // namespace softreel
