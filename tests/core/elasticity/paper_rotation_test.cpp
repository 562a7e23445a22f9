#include "core/elasticity/paper_rotation.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/elasticity/element_rotation.h"
#include "tests/support/random.h"

namespace softreel {
namespace {

using test_support::Random;
using test_support::random_rotation;
using test_support::random_vector;

TetNodes rest_tet(Random& random) {
  TetNodes rest{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.2, 1, 0), Vec3(0.1, 0.3, 0.8)};
  for (Vec3& node : rest) node += 0.1 * random_vector(random);
  return rest;
}

/// Moves each node by about `amount`, then turns the element.
TetNodes deformed_tet(const TetNodes& rest, double amount, const Quaternion& turn, Random& random) {
  TetNodes deformed;
  for (std::size_t k = 0; k < 4; ++k) deformed[k] = turn * (rest[k] + amount * random_vector(random));
  return deformed;
}

Quaternion turned(const Quaternion& q, double angle, Random& random) {
  return q * Quaternion(Eigen::AngleAxisd(angle, random_vector(random).normalized()));
}

Vec4 back_rotation(const Quaternion& q) {
  return {q.w(), -q.x(), -q.y(), -q.z()};
}

TEST(StepPaperNewton, ConvergesQuadratically) {
  Random random(1);
  int measured = 0;
  for (int sample = 0; sample < 50; ++sample) {
    const TetNodes rest = rest_tet(random);
    const TetNodes deformed = deformed_tet(rest, 0.1, random_rotation(random), random);
    const Quaternion solution = find_element_rotation(rest, deformed, Quaternion::Identity());
    const RotationEnergy energy(rest, deformed);
    const Vec4 start = back_rotation(turned(solution, 0.1, random)), end = back_rotation(solution);
    PaperState state{start, energy.multiplier(start)};
    std::vector<double> errors{(start - end).norm()};
    while (errors.back() > 1e-14 && errors.size() < 8) {
      const auto next = step_paper_newton(energy, state);
      ASSERT_TRUE(next.has_value());
      state = *next;
      errors.push_back((state.q - end).norm());
    }
    EXPECT_LE(errors.back(), 1e-14);
    EXPECT_LE(errors.size(), 6u);
    for (std::size_t k = 2; k < errors.size() && errors[k] > 1e-13; ++k, ++measured)
      EXPECT_GT(std::log(errors[k] / errors[k - 1]) / std::log(errors[k - 1] / errors[k - 2]), 1.7);
  }
  EXPECT_GE(measured, 50);
}

TEST(FindPaperRotation, EqualsTheSafeRotationNearTheSolution) {
  Random random(2);
  for (int sample = 0; sample < 300; ++sample) {
    const TetNodes rest = rest_tet(random);
    const TetNodes deformed = deformed_tet(rest, 0.03, random_rotation(random), random);
    const Quaternion safe = find_element_rotation(rest, deformed, Quaternion::Identity());
    const Quaternion found = find_paper_rotation(rest, deformed, turned(safe, 0.3, random));
    EXPECT_LT((found.toRotationMatrix() - safe.toRotationMatrix()).norm(), 1e-12);
  }
}

TEST(FindPaperRotation, IsTheSameAtAnySizeOfTheElement) {
  Random random(3);
  for (int sample = 0; sample < 20; ++sample) {
    const TetNodes rest = rest_tet(random);
    const TetNodes deformed = deformed_tet(rest, 0.1, random_rotation(random), random);
    const Quaternion guess = turned(find_element_rotation(rest, deformed, Quaternion::Identity()), 0.2, random);
    const Mat3 expected = find_paper_rotation(rest, deformed, guess).toRotationMatrix();
    for (const double scale : {1e-20, 1e-3, 1e3, 1e20}) {
      TetNodes scaled_rest = rest, scaled_deformed = deformed;
      for (std::size_t k = 0; k < 4; ++k) {
        scaled_rest[k] *= scale;
        scaled_deformed[k] *= scale;
      }
      EXPECT_LT((find_paper_rotation(scaled_rest, scaled_deformed, guess).toRotationMatrix() - expected).norm(), 1e-12);
    }
  }
}

TEST(FindPaperRotation, KeepsTheGuessWhereNewtonHasNoStep) {
  Random random(4);
  const TetNodes regular{Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)};
  const Quaternion guess = random_rotation(random), half_turn(0, 0.6, 0, 0.8);
  TetNodes point, reflected, bad = regular;
  for (std::size_t k = 0; k < 4; ++k) {
    point[k] = Vec3(1, 2, 3);
    reflected[k] = -regular[k];
  }
  EXPECT_TRUE(find_paper_rotation(regular, point, guess).isApprox(guess, 0)) << "Hessian zero";
  EXPECT_TRUE(find_paper_rotation(regular, reflected, half_turn).isApprox(half_turn, 0)) << "triple eigenvalue";
  for (int sample = 0; sample < 50; ++sample) {  // the same, with pivots of round-off
    const Quaternion turn = random_rotation(random), in_space = turned(turn, EIGEN_PI, random);
    TetNodes turned_nodes;
    for (std::size_t k = 0; k < 4; ++k) turned_nodes[k] = turn * reflected[k];
    EXPECT_TRUE(find_paper_rotation(regular, turned_nodes, in_space).isApprox(in_space, 0));
  }
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    bad[2].y() = wrong;
    EXPECT_TRUE(find_paper_rotation(regular, bad, guess).isApprox(guess, 0)) << wrong;
  }
}

TEST(FindPaperRotation, StopsAtOtherStationaryPointsToo) {
  // Why find_rotation checks the eigenvalue: from random guesses the unguarded iteration ends elsewhere, too.
  Random random(5);
  int stationary = 0, least = 0;
  for (int sample = 0; sample < 100; ++sample) {
    const TetNodes rest = rest_tet(random);
    const TetNodes deformed = deformed_tet(rest, 1.0, random_rotation(random), random);
    const RotationEnergy energy(rest, deformed);
    const Vec4 q = back_rotation(find_paper_rotation(rest, deformed, random_rotation(random)));
    EXPECT_NEAR(q.norm(), 1, 1e-14);
    if (energy.gradient(q, energy.multiplier(q)).norm() > 1e-9) continue;
    ++stationary;
    const Vec4 best = back_rotation(find_element_rotation(rest, deformed, Quaternion::Identity()));
    EXPECT_GE(energy.value(q, 0), energy.value(best, 0) - 1e-9);
    if (energy.value(q, 0) < energy.value(best, 0) + 1e-9) ++least;
  }
  EXPECT_GT(stationary, 50);
  EXPECT_GT(least, 0);
  EXPECT_LT(least, stationary);
}

}  // namespace
}  // namespace softreel
