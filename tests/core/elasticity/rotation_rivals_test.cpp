#include "core/elasticity/rotation_rivals.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/bcc_bar.h"
#include "tests/support/random.h"

namespace softreel {
namespace {

using test_support::Random;
using test_support::random_rotation;
using test_support::random_vector;

const TetNodes kRestTet{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.2, 1, 0), Vec3(0.1, 0.3, 0.8)};

Mat3 edges(const TetNodes& nodes) {
  Mat3 columns;
  for (Index k = 0; k < 3; ++k) columns.col(k) = nodes[static_cast<std::size_t>(k) + 1] - nodes[0];
  return columns;
}

TEST(FindQrRotation, LeavesAnUpperTriangularFactorInTheRestFrame) {
  // kRestTet's edge 0-1 and face 0-1-2 lie along x and xy, so its frame is the identity: Q^T D must be triangular.
  Random random(1);
  for (int sample = 0; sample < 100; ++sample) {
    TetNodes deformed;
    for (Vec3& node : deformed) node = random_vector(random);
    const Mat3 Q = find_qr_rotation(kRestTet, deformed, random_rotation(random)).toRotationMatrix();
    const Mat3 factor = Q.transpose() * edges(deformed);
    EXPECT_NEAR(factor(1, 0), 0, 1e-13);
    EXPECT_NEAR(factor(2, 0), 0, 1e-13);
    EXPECT_NEAR(factor(2, 1), 0, 1e-13);
    EXPECT_GT(factor(0, 0), 0);
    EXPECT_GT(factor(1, 1), 0);
    EXPECT_EQ(factor(2, 2) > 0, edges(deformed).determinant() > 0) << "an inversion stays in the factor";
  }
}

TEST(FindQrRotation, FallsBackOnTheGuessWhereTheFaceIsALine) {
  Random random(2);
  for (int sample = 0; sample < 50; ++sample) {
    const Quaternion guess = random_rotation(random);
    const Vec3 axis = random_vector(random).normalized();
    const TetNodes line{Vec3::Zero(), 2 * axis, -3 * axis, axis};
    const Quaternion found = find_qr_rotation(kRestTet, line, guess);
    EXPECT_LT((found * Vec3(1, 0, 0) - axis).norm(), 1e-14);
    EXPECT_NEAR(found.angularDistance(guess), std::acos((guess * Vec3(1, 0, 0)).dot(axis)), 1e-7) << "the least turn";
    const TetNodes no_edge{axis, axis, 2 * axis, Vec3::Zero()};
    EXPECT_TRUE(find_qr_rotation(kRestTet, no_edge, guess).isApprox(guess, 0));
  }
  TetNodes bad = kRestTet;
  bad[2].x() = std::numeric_limits<double>::quiet_NaN();
  const Quaternion guess = random_rotation(random);
  EXPECT_TRUE(find_qr_rotation(kRestTet, bad, guess).isApprox(guess, 0));
}

TEST(FindQrRotation, TurnsALineThatPointsTheOtherWayByHalfATurn) {
  for (const double off : {0.0, 1e-300, 1e-12, 1e-9, 1e-7, 1e-4}) {
    const Vec3 axis = Vec3(-1, off, 0).normalized();
    const TetNodes line{Vec3::Zero(), axis, 2 * axis, -axis};
    const Quaternion found = find_qr_rotation(kRestTet, line, Quaternion::Identity());
    EXPECT_NEAR(found.norm(), 1, 1e-14);
    // The axis of the turn is as good as the root of round-off where the directions are nearly opposite.
    EXPECT_LT((found * Vec3(1, 0, 0) - axis).norm(), 1e-7) << off;
    EXPECT_NEAR(found.angularDistance(Quaternion::Identity()), std::numbers::pi, 2 * off + 1e-7);
  }
}

TEST(FindQrRotation, IsTheSameAtAnyScale) {
  Random random(5);
  for (const double scale : {1e-200, 1e-12, 1e6, 1e200}) {
    const Quaternion q = random_rotation(random);
    TetNodes deformed;
    for (std::size_t k = 0; k < 4; ++k) deformed[k] = q * (scale * kRestTet[k]);
    const Quaternion found = find_qr_rotation(kRestTet, deformed, random_rotation(random));
    EXPECT_LT((found.toRotationMatrix() - q.toRotationMatrix()).norm(), 1e-14) << scale;
  }
}

struct Bar {
  Bar() : mesh(testing::kuhn_bar({3, 2, 2}, Vec3(0.5, 0.3, 0.2))) {
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) mesh.nodes[i] *= 1 + 0.02 * static_cast<double>(i % 5);
    body = make_elastic_body(mesh, std::vector<ElementMaterial>(mesh.tets.size()), Dilatation::Linear);
  }
  TetMesh mesh;
  ElasticBody body;
};

TEST(SmoothRotations, AveragesOverTheElementsThatShareANode) {
  const Bar bar;
  const std::size_t n = bar.mesh.tets.size();
  Random random(3);
  std::vector<Quaternion> rotations, smoothed(n);
  for (std::size_t e = 0; e < n; ++e) rotations.push_back(random_rotation(random));
  smooth_rotations(bar.body, rotations, smoothed, Threads(2));
  std::size_t farthest = 0;
  for (std::size_t e = 0; e < n; ++e) {
    const std::set<Index> own(bar.mesh.tets[e].begin(), bar.mesh.tets[e].end());
    Vec4 sum = Vec4::Zero();
    std::size_t left_out = 0;
    for (std::size_t other = 0; other < n; ++other) {
      bool shares = false;
      for (const Index node : bar.mesh.tets[other]) shares = shares || own.count(node) > 0;
      if (!shares) ++left_out;
      const double sign = rotations[other].dot(rotations[e]) < 0 ? -1 : 1;
      if (shares) sum += sign * bar.body.shapes[other].volume * rotations[other].coeffs();
    }
    farthest = std::max(farthest, left_out);
    EXPECT_LT((smoothed[e].coeffs() - sum.normalized()).norm(), 1e-13) << e;
  }
  EXPECT_GT(farthest, 0u) << "the bar is longer than one ring";
}

TEST(SmoothRotations, DoesNotDependOnTheSignsOfNeighbours) {
  const Bar bar;
  const std::size_t n = bar.mesh.tets.size();
  Random random(4);
  std::vector<Quaternion> rotations, flipped, smoothed(n), smoothed_flipped(n);
  for (std::size_t e = 0; e < n; ++e) {
    rotations.push_back(random_rotation(random));
    flipped.emplace_back(Vec4((e % 3 == 0 ? -1.0 : 1.0) * rotations[e].coeffs()));
  }
  smooth_rotations(bar.body, rotations, smoothed, Threads(1));
  smooth_rotations(bar.body, flipped, smoothed_flipped, Threads(1));
  for (std::size_t e = 0; e < n; ++e)
    EXPECT_LT((smoothed[e].toRotationMatrix() - smoothed_flipped[e].toRotationMatrix()).norm(), 1e-14);
}

}  // namespace
}  // namespace softreel
