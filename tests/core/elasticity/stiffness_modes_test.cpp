/// What the assembled matrix and forces of a whole body must have: symmetry, six null modes, each element's material.
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/elasticity/assembly.h"
#include "tests/support/bcc_bar.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_box.h"
#include "tests/support/random.h"

namespace softreel {
namespace {

using test_support::Random;
using test_support::random_vector;

TetMesh irregular_bar() {
  TetMesh mesh = testing::kuhn_bar({3, 2, 2}, Vec3(0.3, 0.2, 0.2));
  Random random(11);
  for (Vec3& node : mesh.nodes) node += 0.01 * random_vector(random);
  return mesh;
}

std::vector<ElementMaterial> random_materials(std::size_t count) {
  Random random(12);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<ElementMaterial> materials;
  for (std::size_t e = 0; e < count; ++e)
    materials.push_back({1e5 * (1 + 9 * uniform(random)), 0.45 * uniform(random), 1000, 0, 0});
  return materials;
}

Eigen::MatrixXd stiffness(const ElasticBody& body, const std::vector<Vec3>& positions, Curvature curvature) {
  const Threads threads(1);
  std::vector<Quaternion> rotations(body.tets.size(), Quaternion::Identity());
  find_rotations(body, RotationMethod::Consistent, positions, rotations, threads);
  BlockMatrixd matrix{stiffness_pattern(body.tets, static_cast<Index>(positions.size())), {}};
  StiffnessTerms terms;
  find_stiffness_terms(body, positions, rotations, std::vector<double>(body.tets.size(), 1.0), curvature, terms,
                       threads);
  StiffnessAssembler(body.tets, matrix.pattern)
      .assemble(terms, std::vector<double>(positions.size(), 0.0), matrix, threads);
  return test_support::dense(matrix);
}

/// Translations and infinitesimal turns at `positions`, one a column.
Eigen::MatrixXd rigid_modes(const std::vector<Vec3>& positions) {
  Eigen::MatrixXd modes(3 * static_cast<Eigen::Index>(positions.size()), 6);
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const auto row = 3 * static_cast<Eigen::Index>(i);
      modes.col(k).segment<3>(row) = Vec3::Unit(k);
      modes.col(3 + k).segment<3>(row) = Vec3::Unit(k).cross(positions[i]);
    }
  return modes;
}

TEST(Stiffness, HasExactlySixNullModesAtRestAndAfterARigidMotion) {
  const TetMesh mesh = irregular_bar();
  const ElasticBody body = make_elastic_body(mesh, random_materials(mesh.tets.size()), Dilatation::Linear);
  for (const double angle : {0.0, 1.0, 3.14159265358979})
    for (const Curvature curvature : {Curvature::None, Curvature::Signed, Curvature::PositivePart}) {
      const Mat3 turn = Eigen::AngleAxisd(angle, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
      std::vector<Vec3> positions = mesh.nodes;
      for (Vec3& p : positions) p = turn * p + Vec3(1, 2, 3);
      const Eigen::MatrixXd K = stiffness(body, positions, curvature);
      EXPECT_EQ(K, K.transpose());
      const Eigen::VectorXd values = test_support::eigenvalues(K);
      const double greatest = values[values.size() - 1];
      EXPECT_LT(std::abs(values[0]), 1e-13 * greatest);
      EXPECT_LT(std::abs(values[5]), 1e-13 * greatest);
      EXPECT_GT(values[6], 1e-5 * greatest) << "the seventh is a deformation";
      EXPECT_LT((K * rigid_modes(positions)).cwiseAbs().maxCoeff(), 1e-13 * greatest * 10);
    }
}

std::vector<Vec3> forces_of(const ElasticBody& body, const std::vector<Vec3>& positions,
                            const std::vector<Quaternion>& rotations) {
  std::vector<Mat3> stresses(body.tets.size());
  std::vector<Vec3> forces(positions.size());
  find_stresses(body, positions, rotations, stresses, Threads(1));
  gather_forces(body, stresses, forces, Threads(1));
  return forces;
}

TEST(SmallStrain, HasTheGradientOfItsEnergyAndNoTorqueAboutTheRestShape) {
  const TetMesh mesh = irregular_bar();
  const ElasticBody body = make_elastic_body(mesh, random_materials(mesh.tets.size()), Dilatation::Linear);
  const std::vector<Quaternion> none(mesh.tets.size(), Quaternion::Identity());
  Random random(13);
  std::vector<Vec3> positions = mesh.nodes, direction(mesh.nodes.size());
  for (Vec3& p : positions) p += 0.02 * random_vector(random);
  for (Vec3& d : direction) d = random_vector(random);
  const std::vector<Vec3> forces = forces_of(body, positions, none);
  const auto energy = [&](double step) {
    std::vector<Vec3> moved = positions;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += step * direction[i];
    return elastic_energy(body, moved, none, Threads(1));
  };
  double slope = 0, size = 0;
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero(), torque_in_space = Vec3::Zero();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    slope -= forces[i].dot(direction[i]);
    size += forces[i].norm();
    sum += forces[i];
    torque += mesh.nodes[i].cross(forces[i]);
    torque_in_space += positions[i].cross(forces[i]);
  }
  // The energy is quadratic, so the difference quotient has no error but round-off.
  EXPECT_NEAR((energy(1e-3) - energy(-1e-3)) / 2e-3, slope, 1e-10 * size);
  EXPECT_LT(sum.norm(), 1e-13 * size);
  EXPECT_LT(torque.norm(), 1e-13 * size);
  EXPECT_GT(torque_in_space.norm(), 1e-6 * size) << "small strain has one about where the nodes are";
}

TEST(ElasticBody, TakesEveryElementsOwnMaterial) {
  const TetMesh mesh = irregular_bar();
  const std::vector<ElementMaterial> materials = random_materials(mesh.tets.size());
  const ElasticBody body = make_elastic_body(mesh, materials, Dilatation::Capped);
  Random random(14);
  std::vector<Vec3> positions = mesh.nodes;
  for (Vec3& p : positions) p += 0.02 * random_vector(random);
  const std::vector<Quaternion> guesses(mesh.tets.size(), Quaternion::Identity());
  std::vector<Quaternion> rotations = guesses;
  find_rotations(body, RotationMethod::Consistent, positions, rotations, Threads(1));
  const std::vector<Vec3> forces = forces_of(body, positions, rotations);
  std::vector<Vec3> expected(forces.size(), Vec3::Zero());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const double E = materials[e].youngs_modulus, nu = materials[e].poisson_ratio;
    const ElasticLaw law{E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)), true};
    const Mat3 F = deformation_gradient(body.shapes[e].gradients, nodes_of(mesh.tets[e], positions));
    const Mat3 stress = corotated_stress(law, rotations[e].toRotationMatrix(), F);
    for (int k = 0; k < 4; ++k)
      expected[static_cast<std::size_t>(mesh.tets[e][static_cast<std::size_t>(k)])] -=
          body.shapes[e].volume * stress * body.shapes[e].gradients.col(k);
  }
  double greatest = 0, error = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    greatest = std::max(greatest, expected[i].norm());
    error = std::max(error, (forces[i] - expected[i]).norm());
  }
  EXPECT_LT(error, 1e-13 * greatest);
}

}  // namespace
}  // namespace softreel
