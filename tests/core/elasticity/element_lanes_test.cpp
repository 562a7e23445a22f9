#include "core/elasticity/element_lanes.h"

#include <random>

#include <gtest/gtest.h>

#include "core/elasticity/elastic_body.h"
#include "core/elasticity/element_rotation.h"
#include "tests/support/random.h"

namespace softreel {
namespace {

using test_support::random_matrix;

/// Separate tetrahedra, deformed by F and far from the origin.
struct Scattered {
  explicit Scattered(const std::vector<Mat3>& deformations) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    for (const Mat3& F : deformations) {
      const auto first = static_cast<Index>(rest.size());
      TetNodes nodes{vector(), vector(), vector(), vector()};
      if (tet_volume(nodes[0], nodes[1], nodes[2], nodes[3]) < 0) std::swap(nodes[0], nodes[1]);
      const Vec3 offset = 10 * vector();
      for (const Vec3& node : nodes) {
        rest.push_back(node);
        positions.push_back(F * node + offset);
      }
      tets.push_back({first, first + 1, first + 2, first + 3});
      shapes.push_back(find_element_shape(nodes));
    }
    laws.assign(tets.size(), {1, 1, false});
    guesses.assign(tets.size(), Quaternion::Identity());
  }

  std::vector<Quaternion> found() const {
    std::vector<Quaternion> rotations = guesses;
    const std::vector<ElementBatch> batches = make_element_batches(tets, shapes, laws);
    find_consistent_rotations(batches, positions, rotations, 0, batches.size());
    return rotations;
  }

  std::vector<Vec3> rest, positions;
  std::vector<Tet> tets;
  std::vector<ElementShape> shapes;
  std::vector<ElasticLaw> laws;
  std::vector<Quaternion> guesses;
};

Mat3 turn(double angle) {
  return Eigen::AngleAxisd(angle, Vec3(1, -2, 3).normalized()).toRotationMatrix();
}

/// tr(R^T F), which the rotation maximises.
double rotation_objective(const Quaternion& rotation, const Mat3& F) {
  return rotation.toRotationMatrix().cwiseProduct(F).sum();
}

TEST(ConsistentRotations, AreAsGoodAsThoseOfTheScalarTwinOnEveryKindOfDeformation) {
  std::mt19937_64 random(1);
  std::vector<Mat3> deformations;
  for (int k = 0; k < 203; ++k) {  // not a multiple of the lanes; half of them are inverted
    const Mat3 M = random_matrix(random);
    deformations.push_back(M);
    deformations.push_back(turn(0.02 * k) * (Mat3::Identity() + 0.05 * M));
    deformations.push_back(1e6 * M);
    deformations.push_back(1e-6 * M);
    deformations.push_back(M * Vec3(1, 1, 0).asDiagonal());
    deformations.push_back(M * Vec3(1, 0, 0).asDiagonal());
    deformations.push_back(turn(0.03 * k) * Vec3(1, 1, -1).asDiagonal());
  }
  deformations.push_back(Mat3::Zero());
  deformations.push_back(-Mat3::Identity());
  const Scattered scattered(deformations);
  const std::vector<Quaternion> rotations = scattered.found();
  for (std::size_t e = 0; e < deformations.size(); ++e) {
    const Mat3 F =
        deformation_gradient(scattered.shapes[e].gradients, nodes_of(scattered.tets[e], scattered.positions));
    const Quaternion scalar = find_rotation(F, Quaternion::Identity());
    EXPECT_NEAR(rotations[e].norm(), 1, 1e-14);
    EXPECT_GE(rotation_objective(rotations[e], F), rotation_objective(scalar, F) - 1e-13 * F.norm()) << e;
  }
}

TEST(ConsistentRotations, AgreeWithTheScalarTwinToRoundOffWhereTheMaximumIsSharp) {
  std::mt19937_64 random(2);
  std::vector<Mat3> deformations;
  for (int k = 0; k < 401; ++k)
    deformations.push_back(turn(0.01 * k) * (Mat3::Identity() + 0.1 * random_matrix(random)));
  Scattered scattered(deformations);
  for (std::size_t e = 0; e < deformations.size(); ++e) scattered.guesses[e] = Quaternion(turn(0.01 * e + 0.05));
  const std::vector<Quaternion> rotations = scattered.found();
  for (std::size_t e = 0; e < deformations.size(); ++e) {
    const Mat3 F =
        deformation_gradient(scattered.shapes[e].gradients, nodes_of(scattered.tets[e], scattered.positions));
    const Quaternion scalar = find_rotation(F, scattered.guesses[e]);
    EXPECT_LT((rotations[e].coeffs() - scalar.coeffs()).norm(), 1e-13);
  }
}

TEST(ConsistentRotations, KeepTheGuessWhereThereIsNothingToFind) {
  Scattered scattered(std::vector<Mat3>(3, Mat3::Identity()));
  for (Quaternion& guess : scattered.guesses) guess = Quaternion(turn(1));
  for (std::size_t k = 4; k < 8; ++k) scattered.positions[k].setConstant(std::numeric_limits<double>::quiet_NaN());
  const std::vector<Quaternion> rotations = scattered.found();
  EXPECT_LT((rotations[0].coeffs() - Quaternion::Identity().coeffs()).norm(), 1e-14);
  EXPECT_EQ(rotations[1].coeffs(), scattered.guesses[1].coeffs());
  EXPECT_LT((rotations[2].coeffs() - Quaternion::Identity().coeffs()).norm(), 1e-14);
}

}  // namespace
}  // namespace softreel
