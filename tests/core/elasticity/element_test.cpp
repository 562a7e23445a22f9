#include "core/elasticity/element.h"

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/elasticity/element_rotation.h"

namespace softreel {
namespace {

const TetNodes kRest{Vec3(0.1, 0, 0), Vec3(1, 0.1, 0), Vec3(0.2, 1, 0.1), Vec3(0.1, 0.3, 0.8)};

Quaternion polar(const Mat3& F) {
  return find_rotation(F, Quaternion::Identity());
}

/// Deformed nodes: F X + noise.
TetNodes deformed_by(const Mat3& F, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TetNodes nodes;
  for (std::size_t k = 0; k < 4; ++k)
    nodes[k] = F * kRest[k] + noise * Vec3(normal(random), normal(random), normal(random));
  return nodes;
}

/// Mild, bent, far stretched (over the cap), squeezed and inverted shapes.
std::vector<TetNodes> shapes() {
  const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return {deformed_by(Mat3::Identity(), 0.05, 1), deformed_by(turn, 0.3, 2),
          deformed_by(turn * Vec3(4, 1.2, 1.1).asDiagonal(), 0.05, 3),
          deformed_by(turn * Vec3(0.3, 0.6, 1).asDiagonal(), 0.05, 4),
          deformed_by(turn * Vec3(1, 0.8, -0.4).asDiagonal(), 0.05, 5)};
}

double energy(const ElasticLaw& law, const ElementShape& shape, const TetNodes& nodes) {
  const Mat3 F = deformation_gradient(shape.gradients, nodes);
  return shape.volume * corotated_energy(law, polar(F).toRotationMatrix(), F);
}

Eigen::Matrix<double, 12, 1> gradient(const ElasticLaw& law, const ElementShape& shape, const TetNodes& nodes) {
  const Mat3 F = deformation_gradient(shape.gradients, nodes);
  const Mat3 stress = shape.volume * corotated_stress(law, polar(F).toRotationMatrix(), F);
  Eigen::Matrix<double, 12, 1> result;
  for (int i = 0; i < 4; ++i) result.segment<3>(3 * i) = stress * shape.gradients.col(i);
  return result;
}

TetNodes moved(TetNodes nodes, int entry, double by) {
  nodes[static_cast<std::size_t>(entry / 3)][entry % 3] += by;
  return nodes;
}

TEST(ElementShape, ReproducesAffineMaps) {
  const ElementShape shape = find_element_shape(kRest);
  Mat3 F;
  F << 1.2, 0.3, -0.1, 0.2, 0.9, 0.4, 0, -0.2, 1.1;
  TetNodes nodes;
  for (std::size_t k = 0; k < 4; ++k) nodes[k] = F * kRest[k] + Vec3(100, -50, 3);
  EXPECT_LT((deformation_gradient(shape.gradients, nodes) - F).norm(), 1e-13);
  EXPECT_LT(shape.gradients.rowwise().sum().norm(), 1e-15);
}

TEST(ElasticLaw, IsTheLinearLawBelowItsCap) {
  const ElasticLaw capped{3, 1, true}, linear{3, 1, false};
  const double limit = capped.pressure_limit() / capped.lambda;
  for (const double trace : {-2.0, -0.1, 0.0, 0.5 * limit, limit}) {
    EXPECT_EQ(capped.pressure(trace), linear.pressure(trace));
    EXPECT_EQ(capped.pressure_energy(trace), linear.pressure_energy(trace));
  }
  EXPECT_EQ(capped.pressure(10), capped.pressure_limit());
  EXPECT_EQ(capped.pressure_slope(10), 0);
}

TEST(ElasticLaw, HasThePressureAsDerivativeOfItsEnergy) {
  const ElasticLaw law{3, 1, true};
  for (const double trace : {-1.0, 0.2, 0.466, 0.467, 2.0})
    EXPECT_NEAR(law.pressure(trace), (law.pressure_energy(trace + 1e-6) - law.pressure_energy(trace - 1e-6)) / 2e-6,
                1e-5);
}

TEST(ElasticLaw, KeepsItsThicknessUnderUniaxialStressAndLeavesSmallStretchAlone) {
  for (const double nu : {0.3, 0.45, 0.499}) {
    const double mu = 1 / (2 * (1 + nu)), lambda = nu / ((1 + nu) * (1 - 2 * nu));
    const ElasticLaw law{lambda, mu, true};
    for (const double stretch : {1.1, 1.3, 2.0, 5.0, 20.0}) {
      // Lateral stress 2 mu (s - 1) + p(stretch + 2 s - 3) = 0 by bisection: it rises with s.
      double low = -10, high = 1;
      for (int k = 0; k < 200; ++k) {
        const double s = 0.5 * (low + high);
        (2 * mu * (s - 1) + law.pressure(stretch + 2 * s - 3) > 0 ? high : low) = s;
      }
      EXPECT_GE(low, ElasticLaw::kThinnest - 1e-9) << "nu " << nu << " stretch " << stretch;
      if (stretch < 1 + 0.7 / nu) {
        EXPECT_NEAR(low, 1 - nu * (stretch - 1), 1e-9);
      }
    }
  }
}

TEST(CorotatedStress, IsTheGradientOfTheEnergy) {
  const ElementShape shape = find_element_shape(kRest);
  for (const bool capped : {false, true})
    for (const TetNodes& nodes : shapes()) {
      const ElasticLaw law{3, 1, capped};
      const auto found = gradient(law, shape, nodes);
      for (int k = 0; k < 12; ++k) {
        const double step = 1e-6;
        const double difference =
            (energy(law, shape, moved(nodes, k, step)) - energy(law, shape, moved(nodes, k, -step))) / (2 * step);
        EXPECT_NEAR(found[k], difference, 1e-7 * (1 + found.norm()));
      }
    }
}

TEST(CorotatedStress, HasNoForceAndNoTorqueUnderRigidMotion) {
  const ElementShape shape = find_element_shape(kRest);
  const ElasticLaw law{3, 1, true};
  for (const double angle : {0.0, 1.0, 3.14159, 5.0}) {
    const Mat3 turn = Eigen::AngleAxisd(angle, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    TetNodes nodes;
    for (std::size_t k = 0; k < 4; ++k) nodes[k] = turn * kRest[k] + Vec3(5, 6, 7);
    EXPECT_LT(gradient(law, shape, nodes).norm(), 1e-13);
  }
}

TEST(CorotatedStress, SumsToNoForceAndNoTorqueInAnyShape) {
  const ElementShape shape = find_element_shape(kRest);
  const ElasticLaw law{3, 1, true};
  for (const TetNodes& nodes : shapes()) {
    const auto forces = gradient(law, shape, nodes);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (int i = 0; i < 4; ++i) {
      force += forces.segment<3>(3 * i);
      torque += nodes[static_cast<std::size_t>(i)].cross(Vec3(forces.segment<3>(3 * i)));
    }
    EXPECT_LT(force.norm(), 1e-13 * (1 + forces.norm()));
    EXPECT_LT(torque.norm(), 1e-13 * (1 + forces.norm()));
  }
}

TEST(ElementStiffness, IsTheDerivativeOfTheForceAtAFixedRotation) {
  const ElementShape shape = find_element_shape(kRest);
  const ElasticLaw law{3, 1, false};
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const auto K = element_stiffness(shape, law.lambda, law.mu, turn);
  EXPECT_LT((K - K.transpose()).norm(), 1e-14);
  const TetNodes nodes = shapes()[1];
  for (int k = 0; k < 12; ++k) {
    const Mat3 dF =
        deformation_gradient(shape.gradients, moved(nodes, k, 1)) - deformation_gradient(shape.gradients, nodes);
    const Mat3 F = deformation_gradient(shape.gradients, nodes);
    const Mat3 stress = shape.volume * (corotated_stress(law, turn, F + dF) - corotated_stress(law, turn, F));
    for (int i = 0; i < 4; ++i) EXPECT_LT((K.block<3, 1>(3 * i, k) - stress * shape.gradients.col(i)).norm(), 1e-13);
  }
}

TEST(RotationCurvature, MakesTheTangentExact) {
  const ElementShape shape = find_element_shape(kRest);
  for (const bool capped : {false, true})
    for (const TetNodes& nodes : shapes()) {
      const ElasticLaw law{3, 1, capped};
      const Mat3 F = deformation_gradient(shape.gradients, nodes);
      const Mat3 Q = polar(F).toRotationMatrix();
      const double slope = law.pressure_slope(Q.cwiseProduct(F).sum() - 3);
      const Mat3 C = rotation_curvature(law, Q, F, false);
      const Gradients a = Q * shape.gradients;
      auto tangent = element_stiffness(shape, slope, law.mu, Q);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
          const auto cross = [](const Vec3& v) {
            return (Mat3() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
          };
          tangent.block<3, 3>(3 * i, 3 * j) += shape.volume * cross(a.col(i)) * C * cross(a.col(j)).transpose();
        }
      const double step = 1e-6;
      for (int k = 0; k < 12; ++k) {
        const Eigen::Matrix<double, 12, 1> difference =
            (gradient(law, shape, moved(nodes, k, step)) - gradient(law, shape, moved(nodes, k, -step))) / (2 * step);
        EXPECT_LT((tangent.col(k) - difference).norm(), 1e-6 * tangent.norm());
      }
      const Eigen::SelfAdjointEigenSolver<Mat3> positive(rotation_curvature(law, Q, F, true));
      EXPECT_GE(positive.eigenvalues().minCoeff(), -1e-14);
    }
}

}  // namespace
}  // namespace softreel
