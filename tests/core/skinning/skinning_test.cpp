#include "core/skinning/skinning.h"

#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/mesh/corner_normals.h"
#include "core/tetmesh/stuffing/boundary_mending.h"
#include "core/tetmesh/stuffing/isosurface_stuffing.h"
#include "tests/support/surfaces.h"

namespace softreel {
namespace {

/// A ball of tetrahedra and a sphere of points on its surface.
struct Ball {
  TetMesh mesh;
  std::vector<Vec3> points, normals;
};

TetMesh fill(const std::function<double(const Vec3&)>& distance, double spacing) {
  Bounds box;
  box.add(Vec3::Constant(-1.5));
  box.add(Vec3::Constant(1.5));
  StuffedMesh stuffed = stuff_isosurface(sample_distance({Vec3(0.01, 0.02, 0.03), spacing}, box, distance), Threads(1));
  mend_boundary(stuffed);
  return std::move(stuffed.mesh);
}

Ball make_ball() {
  Ball ball{fill([](const Vec3& p) { return p.norm() - 1.0; }, 0.2), {}, {}};
  ball.points = test::make_sphere(1, 8, Vec3::Zero()).positions;
  for (const Vec3& p : ball.points) ball.normals.push_back(p.normalized());
  return ball;
}

Vec3 embedded_point(const Embedding& embedding, const TetMesh& mesh, std::size_t i) {
  Vec3 sum = Vec3::Zero();
  const Tet& tet = mesh.tets[static_cast<std::size_t>(embedding.elements[i])];
  for (std::size_t k = 0; k < 4; ++k) sum += embedding.weights[i][k] * mesh.nodes[static_cast<std::size_t>(tet[k])];
  return sum;
}

std::vector<Vec3> moved(const std::vector<Vec3>& points, const Mat3& A, const Vec3& t) {
  std::vector<Vec3> result;
  for (const Vec3& p : points) result.push_back(A * p + t);
  return result;
}

Mat3 shear() {
  Mat3 A;
  A << 1.2, 0.4, 0.1, -0.2, 0.9, 0.3, 0.0, 0.25, 1.1;
  return A;
}

TEST(SkinPositions, CarryWhatIsFarOutsideAlongWithARigidTurn) {
  TetMesh mesh;
  mesh.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.tets = {{0, 1, 2, 3}};
  const std::vector<Vec3> points{Vec3(0.2, 0.2, 0.2), Vec3(1.2, 0.1, 0.1), Vec3(6, 0.1, 0.2), Vec3(-3, -4, -5)};
  const std::vector<Vec3> normals(points.size(), Vec3::UnitX());
  const Embedding embedding = embed_points(points, normals, mesh, Threads(1));
  EXPECT_EQ(skin_positions(points, embedding, mesh, mesh.nodes, Threads(1)), points);
  const Eigen::AngleAxisd turn(1.7, Vec3(1, 2, 3).normalized());
  const Vec3 shift(5, -2, 1);
  std::vector<Vec3> turned;
  for (const Vec3& node : mesh.nodes) turned.push_back(turn * node + shift);
  const std::vector<Vec3> carried = skin_positions(points, embedding, mesh, turned, Threads(1));
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((carried[i] - (turn * points[i] + shift)).norm(), 1e-13) << i;
}

TEST(EmbedPoints, WeightsReproduceThePoints) {
  const Ball ball = make_ball();
  const Embedding embedding = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  for (std::size_t i = 0; i < ball.points.size(); ++i) {
    EXPECT_NEAR((embedded_point(embedding, ball.mesh, i) - ball.points[i]).norm(), 0, 1e-13);
    double total = 0;
    for (const double w : embedding.weights[i]) {
      EXPECT_LE(std::abs(w), 2);
      total += w;
    }
    EXPECT_NEAR(total, 1, 1e-13);
  }
}

TEST(EmbedPoints, FindsTheElementThatHoldsAPointInside) {
  const Ball ball = make_ball();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-0.5, 0.5);
  std::vector<Vec3> points;
  for (int i = 0; i < 300; ++i) points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  const std::vector<Vec3> normals(points.size(), Vec3::UnitY());
  const Embedding embedding = embed_points(points, normals, ball.mesh, Threads(1));
  for (const auto& weights : embedding.weights)
    for (const double w : weights) EXPECT_GE(w, -1e-12);
}

TEST(EmbedPoints, StaysOnItsSideOfAGap) {
  // Two plates round a gap at z = 0. The points lie beyond its middle, nearer to the plate they do not belong to.
  const double gap = 0.11;
  const auto plates = [&](const Vec3& p) {
    const double sides = std::max(std::abs(p[0]), std::abs(p[1])) - 1.0;
    return std::max({sides, gap - std::abs(p[2]), std::abs(p[2]) - 0.8});
  };
  const TetMesh mesh = fill(plates, 0.2);
  std::vector<Vec3> points, normals;
  for (double x = -0.8; x < 0.85; x += 0.1)
    for (const double side : {-1.0, 1.0}) {
      points.emplace_back(x, 0.3 * x, -side * 0.2 * gap);
      normals.emplace_back(0, 0, -side);  // out of the plate at `side`
    }
  const Embedding embedding = embed_points(points, normals, mesh, Threads(1));
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3 center = Vec3::Zero();
    for (const Index node : mesh.tets[static_cast<std::size_t>(embedding.elements[i])])
      center += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
    EXPECT_LT(center[2] * normals[i][2], 0);
  }
}

TEST(EmbedPoints, TakesPointsThatAreNoNumbers) {
  const TetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}};
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  const std::vector<Vec3> points{{0.1, 0.1, 0.1}, {nan, 0, 0}, {0, infinite, 0}};
  const Embedding embedding = embed_points(points, {3, Vec3::UnitY()}, mesh, Threads(1));
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(embedding.elements[i], 0) << i;
    EXPECT_NEAR(embedding.weights[i][0], i == 0 ? 0.7 : 1.0, 1e-15) << i;
  }
}

TEST(EmbedPoints, BoundsTheWeightsOfFarPoints) {
  const Ball ball = make_ball();
  const std::vector<Vec3> points{{5, 1, 2}, {-40, 0, 0}}, normals{Vec3::UnitX(), Vec3::UnitX()};
  for (const auto& weights : embed_points(points, normals, ball.mesh, Threads(1)).weights)
    for (const double w : weights) EXPECT_LE(std::abs(w), 2);
}

TEST(EmbedPoints, GivesEqualBitsAtOneAndFourThreads) {
  const Ball ball = make_ball();
  const Embedding one = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  const Embedding four = embed_points(ball.points, ball.normals, ball.mesh, Threads(4));
  EXPECT_EQ(one.elements, four.elements);
  EXPECT_EQ(one.weights, four.weights);
}

TEST(SkinPositions, RestIsExact) {
  const Ball ball = make_ball();
  const Embedding embedding = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  EXPECT_EQ(skin_positions(ball.points, embedding, ball.mesh, ball.mesh.nodes, Threads(1)), ball.points);
}

TEST(SkinPositions, AffineMotionsAreExact) {
  const Ball ball = make_ball();
  const Embedding embedding = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  const Vec3 shift(1, -2, 3);
  const std::vector<Vec3> skinned =
      skin_positions(ball.points, embedding, ball.mesh, moved(ball.mesh.nodes, shear(), shift), Threads(1));
  const std::vector<Vec3> expected = moved(ball.points, shear(), shift);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR((skinned[i] - expected[i]).norm(), 0, 1e-13);
}

TEST(SkinNormals, FollowTheCofactorUnderShear) {
  const Ball ball = make_ball();
  const Embedding embedding = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  const std::vector<Vec3> skinned =
      skin_normals(ball.normals, embedding, ball.mesh, moved(ball.mesh.nodes, shear(), Vec3::Zero()), Threads(1));
  const Mat3 cofactor = shear().determinant() * shear().inverse().transpose();
  for (std::size_t i = 0; i < skinned.size(); ++i)
    EXPECT_NEAR((skinned[i] - (cofactor * ball.normals[i]).normalized()).norm(), 0, 1e-12);
}

TEST(SkinNormals, FollowABend) {
  // x -> (x, y + c x^2 / 2, z): normals of the deformed sphere in closed form, up to the elements' resolution.
  const Ball ball = make_ball();
  const Embedding embedding = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  const double c = 0.5;
  std::vector<Vec3> nodes = ball.mesh.nodes;
  for (Vec3& x : nodes) x[1] += 0.5 * c * x[0] * x[0];
  const std::vector<Vec3> skinned = skin_normals(ball.normals, embedding, ball.mesh, nodes, Threads(1));
  for (std::size_t i = 0; i < skinned.size(); ++i) {
    Mat3 F = Mat3::Identity();
    F(1, 0) = c * ball.points[i][0];
    EXPECT_NEAR((skinned[i] - (F.inverse().transpose() * ball.normals[i]).normalized()).norm(), 0, 0.06);
  }
}

TEST(SkinNormals, RestIsUnchanged) {
  const Ball ball = make_ball();
  const Embedding embedding = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  const std::vector<Vec3> skinned = skin_normals(ball.normals, embedding, ball.mesh, ball.mesh.nodes, Threads(1));
  for (std::size_t i = 0; i < skinned.size(); ++i) EXPECT_NEAR((skinned[i] - ball.normals[i]).norm(), 0, 1e-13);
}

TEST(SkinNormals, OfHardEdgesAreThoseOfTheDeformedFaces) {
  const TetMesh tets = fill([](const Vec3& p) { return p.cwiseAbs().maxCoeff() - 1.1; }, 0.3);
  SurfaceMesh cube = test::make_box(Vec3::Ones(), 3, Vec3::Zero());
  const std::vector<Vec3> smooth = vertex_normals(cube, cube.positions);
  const CornerNormals creases = corner_normals(cube, 0.7);
  ASSERT_FALSE(creases.empty());
  const Embedding embedding = embed_points(cube.positions, smooth, tets, Threads(1));
  const std::vector<Vec3> nodes = moved(tets.nodes, shear(), Vec3(1, 2, 3));
  const std::vector<Vec3> skinned =
      skin_normals(creases.normals, embedding, tets, nodes, Threads(1), creases.vertex_of);
  ASSERT_EQ(skinned.size(), creases.normals.size());
  const std::vector<Vec3> points = skin_positions(cube.positions, embedding, tets, nodes, Threads(1));
  for (std::size_t t = 0; t < cube.triangles.size(); ++t) {
    const auto& [a, b, c] = cube.triangles[t];
    const Vec3 face = (points[at(b)] - points[at(a)]).cross(points[at(c)] - points[at(a)]).normalized();
    for (const Index n : creases.triangles[t]) EXPECT_NEAR((skinned[at(n)] - face).norm(), 0, 1e-11);
  }
  EXPECT_EQ(skin_normals(smooth, embedding, tets, nodes, Threads(4)),
            skin_normals(smooth, embedding, tets, nodes, Threads(1)));
}

TEST(SkinNormals, OfAPointWithSeveralTurnWithIt) {
  TetMesh mesh;
  mesh.nodes = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.tets = {{0, 1, 2, 3}};
  const std::vector<Vec3> points{Vec3(0.1, 0.1, 0.1), Vec3(0.3, 0.2, 0.1)};
  const Embedding embedding = embed_points(points, {2, Vec3::UnitX()}, mesh, Threads(1));
  const Eigen::AngleAxisd turn(1.1, Vec3(3, 1, 2).normalized());
  std::vector<Vec3> turned;
  for (const Vec3& node : mesh.nodes) turned.push_back(turn * node);
  const std::vector<Vec3> rest{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  const std::vector<Index> at_points{0, 1, 1};
  const std::vector<Vec3> skinned = skin_normals(rest, embedding, mesh, turned, Threads(1), at_points);
  ASSERT_EQ(skinned.size(), 3u);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_NEAR((skinned[n] - turn * rest[n]).norm(), 0, 1e-14) << n;
}

TEST(SkinValues, OfAnEvenQuantityAreItsValue) {
  const Ball ball = make_ball();
  const Embedding embedding = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  for (const double value :
       skin_values(std::vector<double>(ball.mesh.tets.size(), 0.3), embedding, ball.mesh, Threads(1)))
    EXPECT_NEAR(value, 0.3, 1e-14);
}

TEST(SkinValues, FollowAQuantityThatVariesAndStayWithinIt) {
  const Ball ball = make_ball();
  const Embedding embedding = embed_points(ball.points, ball.normals, ball.mesh, Threads(1));
  std::vector<double> values;
  double least = 1e300, most = -1e300;
  for (const Tet& tet : ball.mesh.tets) {
    double x = 0;
    for (const Index node : tet) x += 0.25 * ball.mesh.nodes[static_cast<std::size_t>(node)].x();
    values.push_back(x);
    least = std::min(least, x);
    most = std::max(most, x);
  }
  const std::vector<double> skinned = skin_values(values, embedding, ball.mesh, Threads(1));
  for (std::size_t i = 0; i < skinned.size(); ++i) {
    EXPECT_NEAR(skinned[i], ball.points[i].x(), 0.15) << "half an element inside at most";
    EXPECT_GE(skinned[i], least);
    EXPECT_LE(skinned[i], most);
  }
}

}  // namespace
}  // namespace softreel
