#include "core/mesh/winding_number.h"

#include <random>

#include <gtest/gtest.h>

#include "core/tetmesh/surface/row_crossings.h"
#include "core/tetmesh/triangle_tree.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

Vec3 random_point(std::mt19937& random, double half_size) {
  std::uniform_real_distribution<double> coordinate(-half_size, half_size);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

TEST(WindingNumber, IsTheSameQuickly) {
  std::mt19937 random(9);
  SurfaceMesh mesh = test::make_sphere(1, 6, Vec3::Zero());
  for (int layer = 0; layer < 3; ++layer) test::append(mesh, test::make_sphere(0.5, 3, Vec3(0.1, 0.2, 0)));
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.positions[at(t[0])].y() < -0.3; });
  for (int t = 0; t < 50; ++t) {  // long ones, all through each other
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(random_point(random, 2));
    const auto end = static_cast<Index>(mesh.positions.size());
    mesh.triangles.push_back({end - 3, end - 2, end - 1});
  }
  const WindingNumber winding(mesh.positions, mesh.triangles);
  std::vector<Vec3> points = mesh.positions;  // where angles are half a turn either way
  for (const auto& [a, b, c] : mesh.triangles) {
    points.push_back(0.5 * (mesh.positions[at(a)] + mesh.positions[at(b)]));
    points.push_back(0.5 * points.back() + 0.5 * mesh.positions[at(c)]);
  }
  for (int i = 0; i < 3000; ++i) points.push_back(random_point(random, 1.5));
  for (const Vec3& p : points) {
    ASSERT_NEAR(winding.quick(p), winding(p), 1e-9) << p.transpose();
    ASSERT_EQ(std::abs(winding.quick(p)) > 0.5, std::abs(winding(p)) > 0.5) << p.transpose();
  }
}

TEST(WindingNumber, IsOneInsideAndZeroOutside) {
  const SurfaceMesh ball = test::make_sphere(1, 16, Vec3::Zero());
  const WindingNumber winding(ball.positions, ball.triangles);
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random_point(random, 1.5);
    if (std::abs(p.norm() - 1) < 0.02) continue;
    EXPECT_NEAR(winding(p), p.norm() < 1 ? 1 : 0, 0.1);
  }
}

TEST(WindingNumber, IsAHalfInTheMiddleOfAHemispheresOpening) {
  SurfaceMesh bowl = test::make_sphere(1, 16, Vec3::Zero());
  std::erase_if(bowl.triangles, [&](const Triangle& triangle) {
    double top = -1;
    for (const Index v : triangle) top = std::max(top, bowl.positions[static_cast<std::size_t>(v)][1]);
    return top > 1e-9;
  });
  const WindingNumber winding(bowl.positions, bowl.triangles);
  EXPECT_NEAR(winding(Vec3::Zero()), 0.5, 0.05);
  EXPECT_GT(winding(Vec3(0, -0.3, 0)), 0.6);
  EXPECT_LT(winding(Vec3(0, 0.3, 0)), 0.4);
}

TEST(HasIntegerWindings, CountsEveryEdgeBothWays) {
  SurfaceMesh ring = test::make_torus(1, 0.4, 12, 8, Vec3::Zero());
  const auto says = [&] { return has_integer_windings(ring.positions, ring.triangles); };
  EXPECT_TRUE(says());
  const std::vector<Triangle> closed = ring.triangles;
  ring.triangles[5] = {closed[5][1], closed[5][0], closed[5][2]};
  EXPECT_FALSE(says()) << "a triangle is turned over";
  ring.triangles = closed;
  ring.triangles.push_back(closed[5]);
  EXPECT_FALSE(says()) << "a triangle is there twice";
  ring.triangles.push_back({closed[5][1], closed[5][0], closed[5][2]});
  EXPECT_TRUE(says()) << "and once more, turned over";
  ring.triangles.push_back({closed[5][0], closed[5][0], closed[5][2]});
  EXPECT_TRUE(says()) << "a triangle that is a line has each edge both ways";
  for (Triangle& triangle : ring.triangles)  // corners of their own
    for (Index& v : triangle) {
      ring.positions.push_back(ring.positions[at(v)]);
      v = static_cast<Index>(ring.positions.size()) - 1;
    }
  EXPECT_TRUE(says()) << "corners at one place are one";
  ring.triangles.pop_back();
  ring.triangles.erase(ring.triangles.begin());
  EXPECT_FALSE(says()) << "a triangle is missing";
}

TEST(RowCrossings, AgreeWithWindingNumbers) {
  // Overlapping and nested shells, one inside out; corners and edges lie exactly on rows of the lattice.
  SurfaceMesh surface = test::make_box(Vec3::Ones(), 2, Vec3::Zero());
  test::append(surface, test::make_box(Vec3::Ones(), 1, Vec3(0.5, 0.5, 0.5)));
  SurfaceMesh hole = test::make_box(Vec3::Constant(0.25), 1, Vec3::Zero());
  test::turn_inside_out(hole);
  test::append(surface, hole);
  test::append(surface, test::make_torus(1.5, 0.3, 24, 12, Vec3::Zero()));
  const LatticeFrame frame{Vec3::Zero(), 0.25};
  const RowCrossings crossings(surface.positions, surface.triangles, frame);
  const WindingNumber winding(surface.positions, surface.triangles);
  const TriangleTree tree(surface.positions, surface.triangles);
  std::size_t inside = 0;
  for (int z = -17; z <= 17; ++z)
    for (int y = -17; y <= 17; ++y)
      for (int x = -17; x <= 17; ++x) {
        if (((x ^ y) & 1) != 0 || ((x ^ z) & 1) != 0) continue;
        const LatticeNode node{x, y, z};
        EXPECT_EQ(winding_of_node(tree, frame, node), crossings.winding(node)) << x << ' ' << y << ' ' << z;
        const Vec3 p = lattice_position(frame, node);
        if (tree.nearest(p).squared_distance < 1e-20) continue;  // on the surface: either side is right
        EXPECT_EQ(crossings.winding(node), std::lround(winding(p))) << x << ' ' << y << ' ' << z;
        inside += crossings.winding(node) != 0 ? 1 : 0;
      }
  EXPECT_GT(inside, 500U);
}

TEST(RowCrossings, VisitTheNodesWithAWindingNumber) {
  const SurfaceMesh ring = test::make_torus(1, 0.4, 24, 12, Vec3(0.01, 0.02, 0.03));
  const LatticeFrame frame{Vec3::Zero(), 0.2};
  const RowCrossings crossings(ring.positions, ring.triangles, frame);
  LatticeNodeSet visited;
  std::size_t count = 0;
  crossings.visit_inside([&](const LatticeNode& node) {
    EXPECT_TRUE(visited.insert(node));
    EXPECT_NE(crossings.winding(node), 0);
    ++count;
  });
  std::size_t expected = 0;
  for (int z = -16; z <= 16; ++z)
    for (int y = -16; y <= 16; ++y)
      for (int x = -16; x <= 16; ++x)
        if (((x ^ y) & 1) == 0 && ((x ^ z) & 1) == 0 && crossings.winding({x, y, z}) != 0) ++expected;
  EXPECT_EQ(count, expected);
}

}  // namespace
}  // namespace softreel
