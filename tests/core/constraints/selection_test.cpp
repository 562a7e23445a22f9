#include "core/constraints/selection.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

/// A strip of triangles along x: vertices (i, 0) and (i, 0.3) for i in 0..4, and one far vertex that nothing uses.
SurfaceMesh strip() {
  SurfaceMesh mesh;
  for (int i = 0; i < 5; ++i) {
    mesh.positions.emplace_back(10 + i, -2, 0);
    mesh.positions.emplace_back(10 + i, -1.7, 0);
  }
  for (Index i = 0; i < 8; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  mesh.positions.emplace_back(10, -2, 100);
  mesh.groups.push_back({"tail", {0, 1, 10}});
  mesh.groups.push_back({"head", {8, 9}});
  return mesh;
}

Selection only(const SelectionTerm& term) {
  return {{term}};
}

using Points = std::vector<Index>;

TEST(SelectPoints, TakesBoxesInMetersAndInBoxCoordinatesWithTheirSides) {
  EXPECT_EQ(select_points(only({SelectBox{{10, -2, 0}, {11, -2, 0}}}), strip()), Points({0, 2}));
  EXPECT_EQ(select_points(only({SelectBox{{0.75, 0, 0}, {1, 1, 1}}, SelectionUnit::Box}), strip()),
            Points({6, 7, 8, 9}));
  EXPECT_EQ(select_points(only({SelectBox{{0, 1, 0}, {1, 1, 1}}, SelectionUnit::Box}), strip()),
            Points({1, 3, 5, 7, 9}));
}

TEST(SelectPoints, TakesSpheresWithTheirRadiusInHeightsOfTheBox) {
  EXPECT_EQ(select_points(only({SelectSphere{{10, -2, 0}, 1}}), strip()), Points({0, 1, 2}));
  const double one_and_a_bit = 1.05;  // of the height 0.3: not yet the next pair at distance 1
  EXPECT_EQ(select_points(only({SelectSphere{{0, 0, 0}, one_and_a_bit}, SelectionUnit::Box}), strip()), Points({0, 1}));
}

TEST(SelectPoints, TakesTheSideThatThePlanesNormalPointsTo) {
  EXPECT_EQ(select_points(only({SelectPlane{{13, 0, 0}, {1, 0, 0}}}), strip()), Points({6, 7, 8, 9}));
  EXPECT_EQ(select_points(only({SelectPlane{{0.25, 0, 0}, {-1, 0, 0}}, SelectionUnit::Box}), strip()),
            Points({0, 1, 2, 3}));
  // The diagonal of the box's x-y side leaves half of the box, however long the body is.
  EXPECT_EQ(select_points(only({SelectPlane{{0.5, 0.5, 0}, {1, 1, 0}}, SelectionUnit::Box}), strip()),
            Points({1, 3, 5, 7, 8, 9}));
}

TEST(SelectPoints, TakesGroupsNearestPointsAndUnionsOfUsedVerticesOnly) {
  EXPECT_EQ(select_points(only({SelectGroup{"tail"}}), strip()), Points({0, 1}));
  EXPECT_EQ(select_points(only({SelectNearest{{10, -2, 100}, 1}}), strip()), Points({0}));
  EXPECT_EQ(select_points(only({SelectNearest{{1, 0, 0}, 2}, SelectionUnit::Box}), strip()), Points({8, 9}));
  EXPECT_EQ(select_points(only({SelectNearest{{0, 0, 0}, 99}}), strip()).size(), 10U);
  EXPECT_EQ(select_points(only({SelectAll{}}), strip()).size(), 10U);
  EXPECT_EQ(select_points({{{SelectGroup{"head"}}, {SelectGroup{"tail"}}, {SelectGroup{"head"}}}}, strip()),
            Points({0, 1, 8, 9}));
  EXPECT_TRUE(select_points({}, strip()).empty());
}

TEST(SelectPoints, OffersNoGroupOfAMeshThatNamesNone) {
  SurfaceMesh plain = strip();
  plain.groups.clear();
  try {
    select_points(only({SelectGroup{"head"}}), plain);
    FAIL() << "no error";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("it names none"), std::string::npos) << message;
    EXPECT_EQ(message.find("Choose one of them"), std::string::npos) << message;
  }
}

TEST(SelectPoints, NamesTheNearestGroupForAnUnknownOne) {
  try {
    select_points(only({SelectGroup{"heda"}}), strip());
    FAIL() << "no error";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("no vertex group 'heda'"), std::string::npos);
    EXPECT_NE(message.find("'tail', 'head'"), std::string::npos);
    EXPECT_NE(message.find("Did you mean 'head'?"), std::string::npos);
  }
}

TEST(SelectionContains, TestsSpaceDirectlyAndGroupsByTheNearestSurfacePoint) {
  const std::vector<Vec3> points{{10.2, -1.9, 5}, {12, -2, 0}, {13.9, -1.8, 0}};
  const auto in = [&](const SelectionTerm& term) { return contains(only(term), strip(), points); };
  EXPECT_EQ(in({SelectBox{{9, -3, -1}, {13, 0, 1}}}), std::vector<bool>({false, true, false}));
  EXPECT_EQ(in({SelectGroup{"tail"}}), std::vector<bool>({true, false, false}));
  EXPECT_EQ(in({SelectNearest{{14, -2, 0}, 2}}), std::vector<bool>({false, false, true}));
  EXPECT_EQ(in({SelectAll{}}), std::vector<bool>({true, true, true}));
  EXPECT_EQ(contains({{{SelectGroup{"tail"}}, {SelectGroup{"head"}}}}, strip(), points),
            std::vector<bool>({true, false, true}));
  EXPECT_EQ(contains({}, strip(), points), std::vector<bool>(3, false));
}

}  // namespace
}  // namespace softreel
