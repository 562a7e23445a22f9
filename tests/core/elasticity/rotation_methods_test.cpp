/// What every choice of element rotation keeps, and what tells them apart.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/elasticity/elastic_body.h"
#include "tests/support/bcc_bar.h"
#include "tests/support/random.h"

namespace softreel {
namespace {

using test_support::Random;
using test_support::random_matrix;
using test_support::random_rotation;
using test_support::random_vector;

struct Method {
  std::string name;
  RotationMethod method;
};

void PrintTo(const Method& given, std::ostream* out) {
  *out << given.name;
}

const std::vector<Method> kRotating{{"consistent", RotationMethod::Consistent},
                                    {"energy", RotationMethod::Energy},
                                    {"paper", RotationMethod::Paper},
                                    {"polar_smooth", RotationMethod::PolarSmooth},
                                    {"qr", RotationMethod::Qr}};

class EveryRotation : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Methods, EveryRotation, ::testing::ValuesIn(kRotating),
                         [](const auto& tested) { return tested.param.name; });

Quaternion turn(double angle, const Vec3& axis) {
  return Quaternion(Eigen::AngleAxisd(angle, axis.normalized()));
}

ElasticBody body_of(const TetMesh& mesh) {
  ElementMaterial material;
  material.youngs_modulus = 1;
  material.poisson_ratio = 0.3;
  return make_elastic_body(mesh, std::vector<ElementMaterial>(mesh.tets.size(), material), Dilatation::Linear);
}

ElasticBody make_bar_body() {
  return body_of(testing::bcc_bar({5, 4, 3}, 0.1));
}

/// One tetrahedron with random nodes, none of its heights small.
ElasticBody random_tet(Random& random) {
  TetMesh mesh;
  mesh.nodes.resize(4);
  do {
    for (Vec3& node : mesh.nodes) node = random_vector(random);
  } while (std::abs(tet_volume(mesh.nodes[0], mesh.nodes[1], mesh.nodes[2], mesh.nodes[3])) < 0.3);
  mesh.tets = {testing::oriented({0, 1, 2, 3}, mesh.nodes)};
  return body_of(mesh);
}

std::vector<Vec3> mapped(const ElasticBody& body, const Mat3& F) {
  std::vector<Vec3> positions;
  for (const Vec3& X : body.rest_positions) positions.push_back(F * X + Vec3(0.3, -0.1, 0.7));
  return positions;
}

std::vector<Vec3> with_noise(std::vector<Vec3> positions, double amount, Random& random) {
  for (Vec3& p : positions) p += amount * random_vector(random);
  return positions;
}

std::vector<Quaternion> find(const ElasticBody& body, RotationMethod method, const std::vector<Vec3>& positions,
                             std::vector<Quaternion> guesses, int threads = 1) {
  find_rotations(body, method, positions, guesses, Threads(threads));
  return guesses;
}

std::vector<Quaternion> all(const ElasticBody& body, const Quaternion& q) {
  return std::vector<Quaternion>(body.tets.size(), q);
}

std::vector<Vec3> forces_by_method(const ElasticBody& body, const std::vector<Vec3>& positions,
                                   const std::vector<Quaternion>& rotations) {
  const Threads threads(1);
  std::vector<Mat3> stresses(body.tets.size());
  std::vector<Vec3> forces(positions.size());
  find_stresses(body, positions, rotations, stresses, threads);
  gather_forces(body, stresses, forces, threads);
  return forces;
}

double greatest(const std::vector<Vec3>& vectors) {
  double greatest = 0;
  for (const Vec3& v : vectors) greatest = std::max(greatest, v.norm());
  return greatest;
}

double greatest_gap(const std::vector<Quaternion>& a, const std::vector<Quaternion>& b) {
  double greatest = 0;
  for (std::size_t e = 0; e < a.size(); ++e)
    greatest = std::max(greatest, (a[e].toRotationMatrix() - b[e].toRotationMatrix()).norm());
  return greatest;
}

TEST_P(EveryRotation, RecoversThatOfARigidTetrahedron) {
  Random random(1);
  for (int sample = 0; sample < 200; ++sample) {
    const ElasticBody body = random_tet(random);
    const double angle = sample % 4 == 0 ? EIGEN_PI : EIGEN_PI * (sample / 200.0);
    const Quaternion q = turn(angle, random_vector(random));
    // The paper's Newton is for small changes; the others need no guess.
    const bool warm = GetParam().method == RotationMethod::Paper;
    const Quaternion guess = warm ? q * turn(0.2, random_vector(random)) : random_rotation(random);
    const auto found = find(body, GetParam().method, mapped(body, q.toRotationMatrix()), {guess});
    EXPECT_LT((found[0].toRotationMatrix() - q.toRotationMatrix()).norm(), 1e-13) << angle;
  }
}

TEST_P(EveryRotation, IsProperForAnyDeformation) {
  Random random(2);
  const std::vector<Vec3> stretches{{1, 1, 1},      {1, 0.7, 0},  {1, 0, 0},           {0, 0, 0},
                                    {1.1, 1, -0.4}, {-1, -1, -1}, {1e8, 1, 1},         {1, 1, 1e-9},
                                    {1, 1e-9, 0},   {1e30, 1, 0}, {1e-200, 1e-200, 0}, {1e200, -1e199, 1e198}};
  for (int sample = 0; sample < 40; ++sample)
    for (std::size_t k = 0; k <= stretches.size(); ++k) {
      const ElasticBody body = random_tet(random);
      Mat3 F = random_matrix(random);
      if (k > 0)
        F = random_rotation(random).toRotationMatrix() * stretches[k - 1].asDiagonal() *
            random_rotation(random).toRotationMatrix();
      const auto found = find(body, GetParam().method, mapped(body, F), {random_rotation(random)});
      const Mat3 Q = found[0].toRotationMatrix();
      ASSERT_TRUE(Q.allFinite()) << F;
      EXPECT_NEAR(Q.determinant(), 1, 1e-13) << F;
      EXPECT_LT((Q.transpose() * Q - Mat3::Identity()).norm(), 1e-13) << F;
    }
}

TEST_P(EveryRotation, IsProperInAScrambledBody) {
  const ElasticBody body = make_bar_body();
  Random random(3);
  std::vector<Quaternion> rotations = all(body, Quaternion::Identity());
  for (int sample = 0; sample < 5; ++sample) {
    rotations = find(body, GetParam().method, with_noise(mapped(body, Mat3::Identity()), 1.0, random), rotations);
    for (const Quaternion& q : rotations) EXPECT_NEAR(q.norm(), 1, 1e-13);
  }
}

TEST_P(EveryRotation, LeavesNoForceUnderARigidMotion) {
  const ElasticBody body = make_bar_body();
  const double scale = 0.1;  // E h^2 of a unit strain, one order up: 1 Pa, edges of 0.1 m
  std::vector<Quaternion> rotations = all(body, Quaternion::Identity());
  const std::vector<Quaternion> none = rotations;
  for (int step = 1; step <= 24; ++step) {  // two turns; each step starts from the one before
    const Mat3 Q = turn(step * EIGEN_PI / 6, Vec3(1, -2, 0.5)).toRotationMatrix();
    const std::vector<Vec3> positions = mapped(body, Q);
    rotations = find(body, GetParam().method, positions, rotations);
    EXPECT_LT(greatest(forces_by_method(body, positions, rotations)), 1e-14 * scale) << step;
    if (step % 12 != 0) {
      EXPECT_GT(greatest(forces_by_method(body, positions, none)), 1e-2 * scale) << "small strain: the check can fail";
    }
  }
}

TEST_P(EveryRotation, TurnsWithTheBody) {
  // Objectivity: R(Q F) = Q R(F).
  const ElasticBody body = make_bar_body();
  Random random(4);
  const Quaternion Q = turn(2.5, Vec3(0.3, 1, -0.7));
  const Mat3 stretch = Mat3::Identity() + 0.1 * random_matrix(random);
  const std::vector<Vec3> positions = with_noise(mapped(body, stretch), 0.005, random);
  std::vector<Vec3> turned_positions;
  for (const Vec3& p : positions) turned_positions.push_back(Q * p);
  const auto found = find(body, GetParam().method, positions, all(body, Quaternion::Identity()));
  auto expected = found;
  for (Quaternion& q : expected) q = Q * q;
  EXPECT_LT(greatest_gap(find(body, GetParam().method, turned_positions, all(body, Q)), expected), 1e-12);
  EXPECT_GT(greatest_gap(found, all(body, Quaternion::Identity())), 1e-2) << "there is something to find";
}

TEST_P(EveryRotation, IsTheSameForAnyNumberOfThreads) {
  const ElasticBody body = body_of(testing::bcc_bar({9, 8, 7}, 0.1));
  ASSERT_GT(body.tets.size(), 2000u);
  Random random(5);
  const std::vector<Vec3> positions = with_noise(mapped(body, Mat3::Identity()), 0.02, random);
  const auto guesses = all(body, Quaternion::Identity());
  const auto one = find(body, GetParam().method, positions, guesses, 1);
  const auto four = find(body, GetParam().method, positions, guesses, 4);
  for (std::size_t e = 0; e < one.size(); ++e) ASSERT_TRUE(one[e].coeffs() == four[e].coeffs()) << e;
}

TEST_P(EveryRotation, DependsOnTheOrderOfNodesForQrOnly) {
  ElasticBody body = make_bar_body();
  Random random(6);
  const std::vector<Vec3> positions = with_noise(mapped(body, Mat3::Identity()), 0.005, random);
  const auto found = find(body, GetParam().method, positions, all(body, Quaternion::Identity()));
  TetMesh mesh{body.rest_positions, body.tets, {}};
  for (Tet& tet : mesh.tets) tet = {tet[2], tet[0], tet[1], tet[3]};
  const ElasticBody reordered = body_of(mesh);
  const double gap =
      greatest_gap(find(reordered, GetParam().method, positions, all(body, Quaternion::Identity())), found);
  if (GetParam().method == RotationMethod::Qr)
    EXPECT_GT(gap, 0.01);
  else
    EXPECT_LT(gap, 1e-12);
}

TEST(PaperRotation, FollowsTheSafeOneWhileStrainsAreSmall) {
  // A bar that bends and turns step by step, each warm started from the step before.
  const ElasticBody body = make_bar_body();
  auto paper = all(body, Quaternion::Identity()), safe = paper;
  double strain = 0;
  for (int step = 1; step <= 30; ++step) {
    const Mat3 Q = turn(0.15 * step, Vec3(1, 1, 0)).toRotationMatrix();
    std::vector<Vec3> positions;
    for (const Vec3& X : body.rest_positions)
      positions.push_back(Q * (X + 0.005 * step * Vec3(X.y() * X.x(), -0.5 * X.x() * X.x(), X.x() * X.y())));
    paper = find(body, RotationMethod::Paper, positions, paper);
    safe = find(body, RotationMethod::Energy, positions, safe);
    EXPECT_LT(greatest_gap(paper, safe), 1e-12) << step;
    for (std::size_t e = 0; e < body.tets.size(); ++e) {
      const Mat3 F = deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], positions));
      strain = std::max(strain, corotated_strain(safe[e].toRotationMatrix(), F).norm());
    }
  }
  EXPECT_GT(strain, 0.08);
  EXPECT_LT(strain, 0.1);
}

TEST(PolarSmooth, EqualsPolarWhereTheDeformationIsUniform) {
  const ElasticBody body = make_bar_body();
  Random random(7);
  for (int sample = 0; sample < 20; ++sample) {
    const std::vector<Vec3> positions = mapped(body, random_matrix(random));
    const auto guesses = all(body, random_rotation(random));
    EXPECT_LT(greatest_gap(find(body, RotationMethod::PolarSmooth, positions, guesses),
                           find(body, RotationMethod::Consistent, positions, guesses)),
              1e-12);
  }
  const std::vector<Vec3> uneven = with_noise(mapped(body, Mat3::Identity()), 0.01, random);
  const auto guesses = all(body, Quaternion::Identity());
  EXPECT_GT(greatest_gap(find(body, RotationMethod::PolarSmooth, uneven, guesses),
                         find(body, RotationMethod::Consistent, uneven, guesses)),
            0.01);
}

/// How far eq. (3) is from the consistent rotation at F = Q (I + strain E).
struct Gap {
  double rotation, force, torque, scale;
};

Gap gap_at(const ElasticBody& body, RotationMethod method, const Mat3& E, double strain) {
  const Quaternion Q = turn(1.0, Vec3(1, 2, 3));
  const std::vector<Vec3> positions = mapped(body, Q.toRotationMatrix() * (Mat3::Identity() + strain * E));
  const auto consistent = find(body, RotationMethod::Consistent, positions, {Q});
  const auto found = find(body, method, positions, {Q});
  const std::vector<Vec3> exact = forces_by_method(body, positions, consistent),
                          forces = forces_by_method(body, positions, found);
  Gap gap{greatest_gap(found, consistent), 0, 0, 0};
  Vec3 torque = Vec3::Zero();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    gap.force = std::max(gap.force, (forces[i] - exact[i]).norm());
    gap.scale += positions[i].norm() * forces[i].norm();
    torque += positions[i].cross(forces[i]);
  }
  gap.torque = torque.norm();
  return gap;
}

double order(double coarse, double fine) {
  return std::log10(coarse / fine);
}

TEST(Eq3Rotation, IsOffByTheFirstOrderOfStrainAndItsForceAndTorqueByTheSecond) {
  // With F = Q (I + e E) and A = F S, the nearest rotation to A turns by e [E, S] over sums of the moments S: the first
  // order, unless S is a multiple of the identity. As stress is of order e itself, the force and torque are off by e^2.
  Random random(8);
  for (const RotationMethod method : {RotationMethod::Energy, RotationMethod::Paper})
    for (int sample = 0; sample < 20; ++sample) {
      const ElasticBody body = random_tet(random);
      const Mat3 E = random_matrix(random).normalized();
      const Gap coarse = gap_at(body, method, E, 1e-3), fine = gap_at(body, method, E, 1e-4);
      EXPECT_NEAR(order(coarse.rotation, fine.rotation), 1, 0.05);
      EXPECT_NEAR(order(coarse.force, fine.force), 2, 0.05);
      EXPECT_NEAR(order(coarse.torque, fine.torque), 2, 0.05);
      EXPECT_NEAR(order(coarse.scale, fine.scale), 1, 0.05);
      const Gap consistent = gap_at(body, RotationMethod::Consistent, E, 1e-3);
      EXPECT_LT(consistent.torque, 1e-10 * consistent.scale) << "the consistent force has none";
    }
}

TEST(Eq3Rotation, IsTheConsistentOneOnARegularTetrahedron) {
  Random random(9);
  TetMesh mesh{{Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}, {}, {}};
  mesh.tets = {testing::oriented({0, 1, 2, 3}, mesh.nodes)};
  const ElasticBody body = body_of(mesh);
  for (int sample = 0; sample < 50; ++sample) {
    const std::vector<Vec3> positions = mapped(body, random_matrix(random));
    EXPECT_LT(greatest_gap(find(body, RotationMethod::Energy, positions, all(body, Quaternion::Identity())),
                           find(body, RotationMethod::Consistent, positions, all(body, Quaternion::Identity()))),
              1e-11);
  }
}

}  // namespace
}  // namespace softreel
