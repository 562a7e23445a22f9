#include "core/elasticity/assembly.h"

#include <random>

#include <Eigen/SparseCore>
#include <gtest/gtest.h>

#include "core/elasticity/mass.h"
#include "tests/support/bcc_bar.h"

namespace softreel {
namespace {

/// A deformed body of two materials.
struct Deformed {
  explicit Deformed(bool one_material, Dilatation dilatation = Dilatation::Capped, double noise = 0.02)
      : threads(4), mesh(testing::bcc_bar({5, 4, 3}, 0.1)), materials(mesh.tets.size()) {
    if (!one_material)
      for (std::size_t e = 0; e < materials.size(); e += 3) materials[e] = {3e5, 0.2, 700, 0, 0};
    body = make_elastic_body(mesh, materials, dilatation);
    positions = mesh.nodes;
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    const Mat3 turn = Eigen::AngleAxisd(1.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (Vec3& p : positions) p = turn * (p + noise * Vec3(normal(random), normal(random), normal(random)));
    rotations.assign(mesh.tets.size(), Quaternion::Identity());
    find_rotations(body, RotationMethod::Consistent, positions, rotations, threads);
    std::uniform_real_distribution<double> uniform(0.5, 2);
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) shares.push_back(uniform(random));
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) node_terms.push_back(uniform(random));
  }

  BlockMatrixd assembled(Curvature curvature, int thread_count) const {
    const Threads its_threads(thread_count);
    BlockMatrixd matrix{stiffness_pattern(mesh.tets, static_cast<Index>(mesh.nodes.size())), {}};
    StiffnessTerms terms;
    find_stiffness_terms(body, positions, rotations, shares, curvature, terms, its_threads);
    StiffnessAssembler(mesh.tets, matrix.pattern).assemble(terms, node_terms, matrix, its_threads);
    return matrix;
  }

  Threads threads;
  TetMesh mesh;
  std::vector<ElementMaterial> materials;
  ElasticBody body;
  std::vector<Vec3> positions;
  std::vector<Quaternion> rotations;
  std::vector<double> shares, node_terms;
};

Eigen::MatrixXd dense(const BlockMatrixd& matrix) {
  const Index n = matrix.pattern.rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Index i = 0; i < n; ++i)
    for (std::int64_t b = matrix.pattern.row_offsets[static_cast<std::size_t>(i)];
         b < matrix.pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++b)
      result.block<3, 3>(3 * i, 3 * matrix.pattern.column_indices[static_cast<std::size_t>(b)]) =
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrix.block(b));
  return result;
}

/// Each element's 12 x 12 matrix added where its nodes say.
Eigen::MatrixXd scattered(const Deformed& deformed) {
  const auto n = static_cast<Eigen::Index>(deformed.mesh.nodes.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (std::size_t e = 0; e < deformed.mesh.tets.size(); ++e) {
    const Tet& tet = deformed.mesh.tets[e];
    const ElasticLaw& law = deformed.body.laws[e];
    const Mat3 Q = deformed.rotations[e].toRotationMatrix();
    const Mat3 F = deformation_gradient(deformed.body.shapes[e].gradients, nodes_of(tet, deformed.positions));
    const auto K =
        element_stiffness(deformed.body.shapes[e], law.pressure_slope(Q.cwiseProduct(F).sum() - 3), law.mu, Q);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        result.block<3, 3>(3 * tet[static_cast<std::size_t>(i)], 3 * tet[static_cast<std::size_t>(j)]) +=
            deformed.shares[e] * K.block<3, 3>(3 * i, 3 * j);
  }
  for (Eigen::Index i = 0; i < n; ++i)
    result.diagonal().segment<3>(3 * i).array() += deformed.node_terms[static_cast<std::size_t>(i)];
  return result;
}

TEST(StiffnessAssembler, AgreesWithScatteringElementMatrices) {
  for (const bool one_material : {true, false})
    for (const double noise : {0.005, 0.05}) {  // the larger takes some elements over the cap
      const Deformed deformed(one_material, Dilatation::Capped, noise);
      const Eigen::MatrixXd expected = scattered(deformed);
      EXPECT_LT((dense(deformed.assembled(Curvature::None, 1)) - expected).norm(), 1e-14 * expected.norm());
    }
}

TEST(StiffnessAssembler, IsSymmetricToTheLastBit) {
  for (const Curvature curvature : {Curvature::None, Curvature::Signed, Curvature::PositivePart}) {
    const Eigen::MatrixXd K = dense(Deformed(false).assembled(curvature, 1));
    EXPECT_EQ(K, K.transpose());
  }
}

TEST(StiffnessAssembler, HasTheSameBitsOnOneAndFourThreads) {
  const Deformed deformed(false);
  for (const Curvature curvature : {Curvature::None, Curvature::Signed})
    EXPECT_EQ(deformed.assembled(curvature, 1).values, deformed.assembled(curvature, 4).values);
}

TEST(StiffnessAssembler, MakesTheTangentOfTheGatheredForces) {
  Deformed deformed(false);
  deformed.shares.assign(deformed.shares.size(), 1);
  deformed.node_terms.assign(deformed.node_terms.size(), 0);
  const Eigen::MatrixXd K = dense(deformed.assembled(Curvature::Signed, 1));
  const std::size_t n = deformed.mesh.nodes.size();
  const auto forces = [&](const std::vector<Vec3>& positions) {
    std::vector<Quaternion> rotations = deformed.rotations;
    find_rotations(deformed.body, RotationMethod::Consistent, positions, rotations, deformed.threads);
    std::vector<Mat3> stresses(deformed.mesh.tets.size());
    std::vector<Vec3> result(n);
    find_stresses(deformed.body, positions, rotations, stresses, deformed.threads);
    gather_forces(deformed.body, stresses, result, deformed.threads);
    return result;
  };
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  Eigen::VectorXd direction(3 * static_cast<Eigen::Index>(n));
  for (double& d : direction) d = normal(random);
  const double step = 1e-7;
  std::vector<Vec3> ahead = deformed.positions, behind = ahead;
  for (std::size_t i = 0; i < n; ++i) {
    ahead[i] += step * direction.segment<3>(3 * static_cast<Eigen::Index>(i));
    behind[i] -= step * direction.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
  const std::vector<Vec3> f1 = forces(ahead), f0 = forces(behind);
  Eigen::VectorXd difference(direction.size());
  for (std::size_t i = 0; i < n; ++i)
    difference.segment<3>(3 * static_cast<Eigen::Index>(i)) = -(f1[i] - f0[i]) / (2 * step);
  const Eigen::VectorXd product = K * direction;
  EXPECT_LT((product - difference).norm(), 1e-5 * product.norm());
}

TEST(GatherForces, AreTheGradientOfTheEnergyAndSumToNothing) {
  const Deformed deformed(false);
  std::vector<Mat3> stresses(deformed.mesh.tets.size());
  std::vector<Vec3> forces(deformed.mesh.nodes.size());
  find_stresses(deformed.body, deformed.positions, deformed.rotations, stresses, deformed.threads);
  gather_forces(deformed.body, stresses, forces, deformed.threads);
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  double magnitude = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    sum += forces[i];
    torque += deformed.positions[i].cross(forces[i]);
    magnitude += forces[i].norm();
  }
  EXPECT_LT(sum.norm(), 1e-13 * magnitude);
  EXPECT_LT(torque.norm(), 1e-13 * magnitude);
  const auto energy = [&](std::size_t node, const Vec3& by) {
    std::vector<Vec3> positions = deformed.positions;
    positions[node] += by;
    std::vector<Quaternion> rotations = deformed.rotations;
    find_rotations(deformed.body, RotationMethod::Consistent, positions, rotations, deformed.threads);
    return elastic_energy(deformed.body, positions, rotations, deformed.threads);
  };
  const double step = 1e-6;
  for (const std::size_t node : {std::size_t{0}, std::size_t{17}, std::size_t{60}})
    for (int k = 0; k < 3; ++k) {
      const double slope = (energy(node, step * Vec3::Unit(k)) - energy(node, -step * Vec3::Unit(k))) / (2 * step);
      EXPECT_NEAR(forces[node][k], -slope, 1e-6 * forces[node].norm());
    }
}

TEST(FindRotations, OfABodyHaveTheSameBitsOnOneAndFourThreads) {
  const Deformed deformed(true);
  std::vector<Quaternion> one(deformed.mesh.tets.size(), Quaternion::Identity()), four = one;
  find_rotations(deformed.body, RotationMethod::Consistent, deformed.positions, one, Threads(1));
  find_rotations(deformed.body, RotationMethod::Consistent, deformed.positions, four, Threads(4));
  for (std::size_t e = 0; e < one.size(); ++e) EXPECT_EQ(one[e].coeffs(), four[e].coeffs());
}

TEST(LumpMasses, AddUpToTheBodysMass) {
  const Deformed deformed(false);
  const NodalMasses masses = lump_masses(deformed.mesh, deformed.materials);
  double expected = 0, sum = 0;
  for (std::size_t e = 0; e < deformed.mesh.tets.size(); ++e)
    expected += deformed.materials[e].density * deformed.body.shapes[e].volume;
  for (const double mass : masses.mass) sum += mass;
  EXPECT_NEAR(sum, expected, 1e-12 * expected);
}

}  // namespace
}  // namespace softreel
