#include "core/elasticity/element_rotation.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "core/elasticity/jacobi4.h"
#include "tests/support/random.h"

namespace softreel {
namespace {

using test_support::Random;
using test_support::random_matrix;
using test_support::random_rotation;

/// U diag(s) V^T with random rotations U and V.
Mat3 with_singular_values(const Vec3& s, Random& random) {
  return random_rotation(random).toRotationMatrix() * s.asDiagonal() * random_rotation(random).toRotationMatrix();
}

/// Every kind of deformation that must not hurt, with its name.
struct NamedMatrix {
  std::string name;
  Mat3 A;
};

std::vector<NamedMatrix> awkward_matrices() {
  Random random(7);
  std::vector<NamedMatrix> cases;
  const auto add = [&](const std::string& name, const Vec3& s) {
    for (int k = 0; k < 20; ++k) cases.push_back({name, with_singular_values(s, random)});
    cases.push_back({name + ", axis-aligned", Mat3(s.asDiagonal())});
  };
  for (int k = 0; k < 200; ++k) cases.push_back({"random", random_matrix(random)});
  add("rest", Vec3(1, 1, 1));
  add("mild", Vec3(1.2, 1, 0.9));
  add("stretched by 1e6", Vec3(1e6, 1, 1));
  add("squeezed by 1e6", Vec3(1, 1, 1e-6));
  add("sheet stretched by 1e6", Vec3(1e6, 1e6, 1));
  add("flat", Vec3(1, 0.7, 0));
  add("line", Vec3(1, 0, 0));
  add("point", Vec3(0, 0, 0));
  add("inverted", Vec3(1.1, 0.9, -0.3));
  add("inverted, tie of two", Vec3(1, 0.5, -0.5));
  add("inverted, near tie", Vec3(1, 0.5, -0.5 + 1e-9));
  add("inverted, nearer tie", Vec3(1, 0.5, -0.5 + 1e-14));
  add("mirrored tie", Vec3(1, 1, -1));
  add("point reflection", Vec3(-1, -1, -1));
  add("nearly a line", Vec3(1, 1e-9, 1e-12));
  add("nearly a point", Vec3(1e-200, 3e-201, 1e-202));
  add("huge", Vec3(1e200, 3e199, 1e199));
  return cases;
}

/// Greatest tr(R^T A) over all rotations: the sum of singular values, the smallest signed by the determinant.
double best_objective(const Mat3& A) {
  const double scale = A.cwiseAbs().maxCoeff();
  if (scale == 0) return 0;
  const Eigen::JacobiSVD<Mat3> svd(A / scale, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  const Vec3 s = svd.singularValues();
  return scale * (s[0] + s[1] + sign * s[2]);
}

double objective(const Quaternion& q, const Mat3& A) {
  return q.toRotationMatrix().cwiseProduct(A).sum();
}

void expect_best_rotation(const Quaternion& q, const NamedMatrix& given) {
  EXPECT_NEAR(q.norm(), 1, 1e-14) << given.name;
  const double scale = given.A.cwiseAbs().maxCoeff();
  EXPECT_LE(best_objective(given.A) - objective(q, given.A), 1e-13 * scale) << given.name << "\n" << given.A;
}

TEST(FindRotation, ReachesTheBestObjectiveForEveryMatrixFromAnyGuess) {
  Random random(11);
  for (const NamedMatrix& given : awkward_matrices())
    for (int k = 0; k < 4; ++k)
      expect_best_rotation(find_rotation(given.A, k == 0 ? Quaternion::Identity() : random_rotation(random)), given);
}

TEST(FindRotation, GivesWhatNoSampledRotationBeats) {
  Random random(5);
  for (int k = 0; k < 30; ++k) {
    const Mat3 A = random_matrix(random);
    const double found = objective(find_rotation(A, Quaternion::Identity()), A);
    for (int sample = 0; sample < 1000; ++sample) EXPECT_GE(found, objective(random_rotation(random), A));
  }
}

TEST(FindRotation, RecoversARotationToRoundOff) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Quaternion q = random_rotation(random);
    const Vec3 stretch = Vec3(1, 1, 1) + 0.3 * Vec3::Random();
    const Mat3 V = random_rotation(random).toRotationMatrix();
    const Mat3 A = q.toRotationMatrix() * (V * stretch.asDiagonal() * V.transpose());
    EXPECT_LT((find_rotation(A, random_rotation(random)).toRotationMatrix() - q.toRotationMatrix()).norm(), 1e-14);
  }
}

TEST(FindRotation, IsTheSameAtAnyScale) {
  Random random(13);
  for (int k = 0; k < 50; ++k) {
    const Mat3 A = random_matrix(random);
    const Mat3 R = find_rotation(A, Quaternion::Identity()).toRotationMatrix();
    for (const double scale : {1e-200, 1e-12, 1e6, 1e200})
      EXPECT_LT((find_rotation(scale * A, Quaternion::Identity()).toRotationMatrix() - R).norm(), 1e-13);
  }
}

TEST(FindRotation, TurnsTheLeastFromTheGuessAtTies) {
  // A line fixes the axis only: the result is the guess followed by the shortest turn that aligns the axis.
  Random random(17);
  for (int k = 0; k < 50; ++k) {
    const Quaternion guess = random_rotation(random);
    const Vec3 axis = Vec3::Random().normalized(), rest = Vec3::Random().normalized();
    const Mat3 A = axis * rest.transpose();
    const Vec3 from = guess * rest, about = from.cross(axis);
    const Quaternion turn(1 + from.dot(axis), about.x(), about.y(), about.z());
    const Quaternion expected = turn.normalized() * guess;
    EXPECT_LT((find_rotation(A, guess).toRotationMatrix() - expected.toRotationMatrix()).norm(), 1e-12);
  }
}

TEST(FindRotation, KeepsTheGuessWhereNothingIsKnown) {
  const Quaternion guess = Quaternion(1, 2, 3, 4).normalized();
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  Mat3 bad = Mat3::Identity();
  bad(1, 2) = nan;
  EXPECT_TRUE(find_rotation(Mat3::Zero(), guess).isApprox(guess, 0));
  EXPECT_TRUE(find_rotation(bad, guess).isApprox(guess, 0));
  bad(1, 2) = infinity;
  EXPECT_TRUE(find_rotation(bad, guess).isApprox(guess, 0));
}

TEST(FindRotations, AgreesWithItsScalarTwinInEveryLane) {
  Random random(23);
  const std::vector<NamedMatrix> cases = awkward_matrices();
  for (std::size_t first = 0; first < cases.size(); first += 3) {
    MatrixLanes matrices;
    QuaternionLanes rotations;
    std::vector<Quaternion> guesses;
    for (std::size_t lane = 0; lane < kRotationLanes; ++lane) {
      const Mat3& A = cases[(first + lane) % cases.size()].A;
      for (int k = 0; k < 9; ++k) matrices.entries[k][lane] = A(k / 3, k % 3);
      guesses.push_back(random_rotation(random));
      const Quaternion& q = guesses.back();
      const double values[] = {q.w(), q.x(), q.y(), q.z()};
      for (int k = 0; k < 4; ++k) rotations.entries[k][lane] = values[k];
    }
    find_rotations(matrices, rotations);
    for (std::size_t lane = 0; lane < kRotationLanes; ++lane) {
      const NamedMatrix& given = cases[(first + lane) % cases.size()];
      const auto& q = rotations.entries;
      const Quaternion found(q[0][lane], q[1][lane], q[2][lane], q[3][lane]);
      expect_best_rotation(found, given);
      const Quaternion twin = find_rotation(given.A, guesses[lane]);
      if (given.name.find("near") == std::string::npos) {
        EXPECT_GT(std::abs(found.dot(twin)), 1 - 1e-12) << given.name << "\n" << given.A;
      }
    }
  }
}

TEST(FindElementRotation, IsIdentityForPureTranslation) {
  const TetNodes rest{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.2, 1, 0), Vec3(0.1, 0.3, 0.8)};
  TetNodes moved = rest;
  for (Vec3& node : moved) node += Vec3(3, -2, 5);
  EXPECT_LT((find_element_rotation(rest, moved, Quaternion::Identity()).toRotationMatrix() - Mat3::Identity()).norm(),
            1e-14);
}

TEST(FindElementRotation, LeavesTheLeastSquaredDistanceOfEq3) {
  Random random(29);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 50; ++k) {
    TetNodes rest, deformed;
    for (TetNodes* nodes : {&rest, &deformed})
      for (Vec3& node : *nodes) node = Vec3(normal(random), normal(random), normal(random));
    const Vec3 c0 = 0.25 * (rest[0] + rest[1] + rest[2] + rest[3]);
    const Vec3 c = 0.25 * (deformed[0] + deformed[1] + deformed[2] + deformed[3]);
    const auto distance = [&](const Quaternion& q) {
      double sum = 0;  // of the nodes: the integral of eq. (3) is V / 20 times this, as both shapes are centred
      for (std::size_t i = 0; i < 4; ++i) sum += (q.conjugate() * (deformed[i] - c) - (rest[i] - c0)).squaredNorm();
      return sum;
    };
    const double found = distance(find_element_rotation(rest, deformed, Quaternion::Identity()));
    for (int sample = 0; sample < 300; ++sample) EXPECT_LE(found, distance(random_rotation(random)) + 1e-13);
  }
}

TEST(JacobiEigen, AgreesWithEigen) {
  Random random(31);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 100; ++k) {
    detail::Symmetric4<double> m;
    for (double& entry : m) entry = normal(random);
    Eigen::Matrix4d full;
    full << m[0], m[1], m[2], m[3], m[1], m[4], m[5], m[6], m[2], m[5], m[7], m[8], m[3], m[6], m[8], m[9];
    const detail::Eigen4 eigen = detail::jacobi_eigen(m);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Map<const Eigen::Vector4d> u(eigen.vectors[i].data());
      EXPECT_LT((full * u - eigen.values[i] * u).norm(), 1e-14);
      EXPECT_NEAR(u.norm(), 1, 1e-14);
    }
  }
}

}  // namespace
}  // namespace softreel
