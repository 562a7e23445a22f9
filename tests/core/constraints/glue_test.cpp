/// Glue: where it binds, what its springs conserve, and the points that stand for a surface.
#include "core/constraints/glue.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/support/glued_bars.h"

namespace softreel {
namespace {

using testing::constant;
using testing::glued;
using testing::kuhn_bar;
using testing::moved_model;

constexpr double kGap = 0.03;

ElementMaterial soft() {
  ElementMaterial material;
  material.youngs_modulus = 1e5;
  material.poisson_ratio = 0.3;
  return material;
}

/// Two cubes of 0.2 m with a gap between them along x.
BodyModel cubes(double gap = kGap) {
  return glued(moved_model(kuhn_bar({2, 2, 2}, Vec3::Constant(0.2)), soft(), Vec3::Zero(), "left"),
               moved_model(kuhn_bar({3, 3, 3}, Vec3::Constant(0.2)), soft(), Vec3(0.2 + gap, 0.01, -0.02), "right"),
               1.5 * kGap);
}

/// A bent, stretched and turned shape of a model.
std::vector<Vec3> deformed(const BodyModel& model) {
  std::vector<Vec3> positions;
  for (const Vec3& X : model.mesh.nodes)
    positions.emplace_back(Eigen::AngleAxisd(1.0 + 0.8 * X.x(), Vec3(1, 2, 3).normalized()) *
                           Vec3(1.1 * X.x(), X.y() + 0.3 * X.x() * X.x(), 0.9 * X.z()));
  return positions;
}

class BoundCubes : public ::testing::Test {
 protected:
  std::vector<GlueBond> bind(std::span<const Vec3> positions, double frame = 1) const {
    const GluedMesh mesh{model_.mesh, node_elements_, model_.materials, model_.surface_points, model_.embedding};
    return bind_glue(model_.glues[0], 0, mesh, positions, frame);
  }
  ActivePull springs(const std::vector<GlueBond>& bonds, double frame = 1) const {
    return glue_springs(model_.glues[0], bonds, model_.mesh, frame);
  }
  std::vector<Vec3> forces(const ActivePull& pull, const std::vector<Vec3>& positions) const {
    std::vector<Vec3> result(positions.size(), Vec3::Zero());
    add_pull_forces(pull, positions, result);
    return result;
  }

  BodyModel model_ = cubes();
  NodeElements node_elements_ = gather_node_elements(model_.mesh.tets, static_cast<Index>(model_.mesh.nodes.size()));
};

TEST_F(BoundCubes, NothingPullsWhereTheGlueStarts) {
  const std::vector<Vec3> start = deformed(model_);
  const ActivePull pull = springs(bind(start));
  ASSERT_FALSE(pull.springs.empty());
  EXPECT_LT(pull_energy(pull, start), 1e-20 * pull.stiffness);
}

TEST_F(BoundCubes, OnlyPointsThatFaceTheOtherBodyAreBound) {
  const std::vector<GlueBond> bonds = bind(model_.mesh.nodes);
  double area = 0;
  for (const GlueBond& bond : bonds) {
    const GluePoint& point = model_.glues[0].points[static_cast<std::size_t>(bond.point)];
    const Vec3 place = testing::centroid(model_.mesh, static_cast<std::size_t>(point.element));
    EXPECT_GT(place.x(), 0.1);
    EXPECT_GE(bond.element, model_.glues[0].elements.first);
    area += point.area;
  }
  EXPECT_NEAR(area, 0.2 * 0.2, 0.02 * 0.2 * 2) << "the face, and what of its neighbours lies within the distance";
}

TEST_F(BoundCubes, AGapTurnsAndStretchesWithTheBodies) {
  const std::vector<GlueBond> bonds = bind(model_.mesh.nodes);
  std::vector<Vec3> moved;
  const Mat3 turn = Eigen::AngleAxisd(2.5, Vec3(1, -1, 2).normalized()).toRotationMatrix();
  for (const Vec3& X : model_.mesh.nodes)
    moved.emplace_back(turn * Vec3(1.3 * X.x(), X.y(), 0.8 * X.z()) + Vec3(5, 6, 7));
  const ActivePull pull = springs(bonds);
  EXPECT_LT(pull_energy(pull, moved), 1e-20 * pull.stiffness);
}

TEST_F(BoundCubes, ForcesHaveNoSumAndNoMomentAndAreTheGradientOfTheEnergy) {
  for (const double max_force : {0.0, 1.0}) {
    model_.glues[0].max_force = max_force;
    const ActivePull pull = springs(bind(model_.mesh.nodes));
    std::vector<Vec3> positions = deformed(model_);
    const std::vector<Vec3> force = forces(pull, positions);
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    double size = 0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      sum += force[i];
      moment += positions[i].cross(force[i]);
      size += force[i].norm();
    }
    ASSERT_GT(size, 0);
    EXPECT_LT(sum.norm(), 1e-12 * size);
    EXPECT_LT(moment.norm(), 1e-12 * size);
    for (std::size_t i = 0; i < positions.size(); i += 7)
      for (int k = 0; k < 3; ++k) {
        const double step = 1e-6;
        positions[i][k] += step;
        const double above = pull_energy(pull, positions);
        positions[i][k] -= 2 * step;
        const double below = pull_energy(pull, positions);
        positions[i][k] += step;
        EXPECT_NEAR(force[i][k], (below - above) / (2 * step), 1e-6 * size);
      }
  }
}

TEST_F(BoundCubes, GapsCloseInTheFramesThatAreAskedFor) {
  model_.glues[0].close_frames = 10;
  const std::vector<GlueBond> bonds = bind(model_.mesh.nodes, 5);
  const auto root_mean_square = [&](double frame) {
    const ActivePull pull = springs(bonds, frame);
    return std::sqrt(2 * pull_energy(pull, model_.mesh.nodes) / pull.stiffness);
  };
  EXPECT_LT(root_mean_square(5), 1e-12);
  EXPECT_NEAR(root_mean_square(10), 0.5 * root_mean_square(15), 1e-9);
  EXPECT_NEAR(root_mean_square(15), kGap, 0.2 * kGap) << "what is not closed yet is the distance at the start";
  EXPECT_EQ(root_mean_square(15), root_mean_square(40));
}

TEST_F(BoundCubes, StiffnessIsThatOfAllBondsTogether) {
  model_.glues[0].stiffness = constant(700.0);
  EXPECT_NEAR(springs(bind(model_.mesh.nodes)).stiffness, 700, 1e-9);
}

TEST_F(BoundCubes, TooFarApartIsSaidWithTheDistanceThereIs) {
  model_.glues[0].distance = 0.01;
  try {
    bind(model_.mesh.nodes, 3);
    FAIL() << "nothing is within 1 cm";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    for (const char* part : {"glue[0]", "frame 3", "\"left\"", "\"right\"", "distance = 0.01 m", "is 0.03 m away"})
      EXPECT_NE(message.find(part), std::string::npos) << part << " is not in " << message;
  }
}

TEST_F(BoundCubes, AnOverlapIsBoundWithoutLevers) {
  model_ = cubes(-0.04);
  const std::vector<GlueBond> bonds = bind(model_.mesh.nodes);
  for (const GlueBond& bond : bonds)
    for (const double weight : bond.weights) EXPECT_LT(std::abs(weight), 3);
}

/// The surface of a cube of 1 m in two triangles a side, in a fine mesh.
struct PlainCube {
  TetMesh mesh = kuhn_bar({5, 5, 5}, Vec3::Ones());
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  Embedding embedding;

  PlainCube() {
    for (int i = 0; i < 8; ++i) positions.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    embedding = embed_points(positions, std::vector<Vec3>(8, Vec3::UnitY()), mesh, Threads(1));
  }
  std::vector<GluePoint> points(const std::vector<Index>& selected, double spacing) const {
    return make_glue_points(positions, triangles, selected, mesh, embedding, spacing);
  }
  Vec3 place(const GluePoint& point) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k)
      sum += point.weights[k] *
             mesh.nodes[static_cast<std::size_t>(mesh.tets[static_cast<std::size_t>(point.element)][k])];
    return sum;
  }
};

TEST(GluePoints, StandForAllOfTheSurfaceEvenlyHoweverItIsDivided) {
  const PlainCube cube;
  for (const double spacing : {5.0, 0.5, 0.2, 0.11}) {
    double area = 0, largest = 0;
    for (const GluePoint& point : cube.points({0, 1, 2, 3, 4, 5, 6, 7}, spacing)) {
      const Vec3 p = cube.place(point);
      const Vec3 from_side = p.cwiseMin(Vec3::Ones() - p);
      EXPECT_NEAR(from_side.minCoeff(), 0, 1e-12) << "it lies on a side";
      area += point.area;
      largest = std::max(largest, point.area);
    }
    EXPECT_NEAR(area, 6, 1e-9);
    EXPECT_LT(largest, std::max(0.6 * spacing * spacing, spacing < 1 ? 0.0 : 1.0));
  }
}

TEST(GluePoints, StandForTheLongStripsOfATubeToo) {
  // 64 sides of 2 m x 2 mm: rows of equal triangles as small as the spacing asks would be 70,000,000.
  const int sides = 64;
  const double radius = 0.02, length = 2, spacing = 0.0053;
  const TetMesh mesh = kuhn_bar({20, 2, 2}, Vec3(length, 0.05, 0.05));
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<Index> all;
  for (int k = 0; k < sides; ++k) {
    const double turn = 2 * M_PI * k / sides;
    for (const double x : {0.0, length})
      positions.emplace_back(x, 0.025 + radius * std::cos(turn), 0.025 + radius * std::sin(turn));
    const Index a = 2 * k, b = 2 * ((k + 1) % sides);
    triangles.push_back({a, a + 1, b});
    triangles.push_back({b, a + 1, b + 1});
    all.insert(all.end(), {a, a + 1});
  }
  const Embedding embedding =
      embed_points(positions, std::vector<Vec3>(positions.size(), Vec3::UnitY()), mesh, Threads(1));
  double area = 0, largest = 0, moment = 0;
  for (const GluePoint& point : make_glue_points(positions, triangles, all, mesh, embedding, spacing)) {
    area += point.area;
    largest = std::max(largest, point.area);
    const Tet& tet = mesh.tets[static_cast<std::size_t>(point.element)];
    for (std::size_t k = 0; k < 4; ++k)
      moment += point.area * point.weights[k] * mesh.nodes[static_cast<std::size_t>(tet[k])].x();
  }
  const double side = 2 * radius * std::sin(M_PI / sides);
  EXPECT_NEAR(area, sides * side * length, 1e-9);
  EXPECT_NEAR(moment / area, length / 2, 1e-9);
  EXPECT_LT(largest, 1.5 * spacing * spacing);
}

TEST(GluePoints, AVertexTakesTheThirdOfItsTriangles) {
  const PlainCube cube;
  for (const double spacing : {5.0, 0.1}) {
    double area = 0;
    for (const GluePoint& point : cube.points({0}, spacing)) area += point.area;
    EXPECT_NEAR(area, 3 * 0.5 / 3, 0.05) << "vertex 0 has three triangles";
  }
}

}  // namespace
}  // namespace softreel
