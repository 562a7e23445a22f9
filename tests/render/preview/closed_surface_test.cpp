#include "render/preview/closed_surface.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// An octahedron with its faces outward.
MotionMesh octahedron(const Vec3f& center) {
  MotionMesh mesh;
  mesh.times.resize(1);
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f}) mesh.times[0].positions.push_back(center + sign * Vec3f::Unit(axis));
  for (const Index x : {0, 1})
    for (const Index y : {2, 3})
      for (const Index z : {4, 5})
        mesh.triangles.push_back((x + y + z) % 2 == 0 ? Triangle{x, y, z} : Triangle{x, z, y});
  return mesh;
}

SolidSide side_of(const MotionMesh& mesh) {
  return solid_side(mesh.times.back().positions, mesh.triangles);
}

TEST(SolidSide, IsBehindNormalsThatLookOutward) {
  MotionMesh ball = octahedron(Vec3f(5, 1, -2));
  EXPECT_EQ(side_of(ball), SolidSide::Behind);
  for (Triangle& t : ball.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(side_of(ball), SolidSide::Before);
}

TEST(SolidSide, IsNowhereIfThereIsARim) {
  EXPECT_EQ(side_of(square(1, 0, matte(0.5f))), SolidSide::None);
  EXPECT_EQ(solid_side({}, {}), SolidSide::None);
  const MotionMesh whole = octahedron(Vec3f::Zero());
  EXPECT_EQ(side_of(whole), SolidSide::Behind);
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    MotionMesh holed = whole, turned = whole;
    holed.triangles.erase(holed.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    EXPECT_EQ(side_of(holed), SolidSide::None) << t;
    std::swap(turned.triangles[t][0], turned.triangles[t][1]);
    EXPECT_EQ(side_of(turned), SolidSide::None) << t;
  }
}

}  // namespace
}  // namespace softreel
