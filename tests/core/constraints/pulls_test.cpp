#include "core/constraints/pulls.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

/// Two surface points inside elements, one beside the mesh, pulled apart; moved positions.
struct Pulled {
  explicit Pulled(double max_force) {
    mesh = testing::kuhn_bar({2, 1, 1}, Vec3(2, 1, 1));
    points = {Vec3(0.3, 0.2, 0.1), Vec3(1.7, 0.8, 0.6), Vec3(0.5, 0.5, 1.02)};
    embedding.elements = {0, 7, 3};
    embedding.weights = {{0.1, 0.2, 0.3, 0.4}, {0.25, 0.25, 0.25, 0.25}, {-0.1, 0.5, 0.4, 0.2}};
    Transform transform;
    transform.translate = Vec3(1, 0.5, 0);
    transform.rotate.z() = 0.7;
    pull = {"body.bar.pull[0]", {0, 1, 2}, {0.5, 0.3, 0.2}, testing::constant(transform), testing::constant(40.0),
            max_force,          {}};
    positions = mesh.nodes;
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i].y() += 0.1 * std::sin(static_cast<double>(i));
  }

  ActivePull active() const { return active_pulls({pull}, points, embedding, mesh, 1).at(0); }

  TetMesh mesh;
  std::vector<Vec3> points;
  Embedding embedding;
  Pull pull;
  std::vector<Vec3> positions;
};

TEST(ActivePull, HasTheForcesThatItsEnergyGives) {
  for (const double max_force : {0.0, 5.0, 1e6}) {
    const Pulled pulled(max_force);
    const ActivePull active = pulled.active();
    std::vector<Vec3> forces(pulled.positions.size(), Vec3::Zero());
    add_pull_forces(active, pulled.positions, forces);
    const double step = 1e-5;
    for (std::size_t i = 0; i < forces.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        std::vector<Vec3> ahead = pulled.positions, behind = ahead;
        ahead[i][k] += step;
        behind[i][k] -= step;
        EXPECT_NEAR(forces[i][k], -(pull_energy(active, ahead) - pull_energy(active, behind)) / (2 * step), 1e-7);
      }
  }
}

TEST(ActivePull, PullsNoHarderThanItsLimitAndFullyBelowIt) {
  for (const double max_force : {0.5, 5.0, 1e6}) {
    const Pulled pulled(max_force);
    std::vector<Vec3> forces(pulled.positions.size(), Vec3::Zero()), unlimited = forces;
    add_pull_forces(pulled.active(), pulled.positions, forces);
    add_pull_forces(Pulled(0).active(), pulled.positions, unlimited);
    Vec3 sum = Vec3::Zero(), free_sum = Vec3::Zero();
    for (std::size_t i = 0; i < forces.size(); ++i) {
      sum += forces[i];
      free_sum += unlimited[i];
    }
    EXPECT_LE(sum.norm(), max_force * (1 + 1e-12));
    EXPECT_NEAR(sum.normalized().dot(free_sum.normalized()), 1, 1e-12);
    if (max_force == 1e6) {
      EXPECT_EQ(sum, free_sum);
    }
  }
}

TEST(ActivePull, ReachesItsLimitExactlyWhereAllPointsAreEquallyFar) {
  Pulled pulled(5);
  Transform away;
  away.translate = Vec3(3, 0, 0);
  pulled.pull.track = testing::constant(away);
  std::vector<Vec3> forces(pulled.positions.size(), Vec3::Zero());
  add_pull_forces(pulled.active(), pulled.mesh.nodes, forces);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& force : forces) sum += force;
  EXPECT_LT((sum - Vec3(5, 0, 0)).norm(), 1e-12);
}

TEST(ActivePull, HasTheStiffnessOfItsForces) {
  const Pulled pulled(0);
  BlockMatrixd matrix{stiffness_pattern(pulled.mesh.tets, static_cast<Index>(pulled.mesh.nodes.size())), {}};
  matrix.values.assign(9 * static_cast<std::size_t>(matrix.pattern.blocks()), 0.0);
  add_pull_stiffness(pulled.active(), pulled.positions, 0.5, matrix);
  std::vector<Vec3> before(pulled.positions.size(), Vec3::Zero()), after = before, moved = pulled.positions;
  moved[2] += Vec3(1, 2, 3);
  add_pull_forces(pulled.active(), pulled.positions, before);
  add_pull_forces(pulled.active(), moved, after);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::int64_t b = matrix.pattern.find(static_cast<Index>(i), 2);
    const Vec3 product =
        b < 0 ? Vec3::Zero()
              : Vec3(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrix.block(b)) * Vec3(1, 2, 3));
    EXPECT_LT((product + 0.5 * (after[i] - before[i])).norm(), 1e-13);
  }
}

TEST(ActivePull, CostsNothingWhereItsPointsMoveRigidly) {
  // One point is at half an edge from where its bounded weights say.
  Pulled pulled(0);
  pulled.points[2] = Vec3(0.4, 0.9, 1.6);
  pulled.embedding.weights[2] = {0.25, 0.25, 0.25, 0.25};
  const Transform motion = pulled.pull.track.at(1);
  for (std::size_t i = 0; i < pulled.positions.size(); ++i) pulled.positions[i] = motion.apply(pulled.mesh.nodes[i]);
  EXPECT_LT(pull_energy(pulled.active(), pulled.positions), 1e-28);
  std::vector<Grab> grabs(1);
  pulled.pull.grab = true;
  update_grabs({pulled.pull}, pulled.points, pulled.embedding, pulled.mesh, pulled.positions, 1, grabs);
  EXPECT_LT((grabs[0].positions.at(2) - motion.apply(pulled.points[2])).norm(), 1e-14)
      << "it is taken where it is seen";
}

TEST(ActivePull, KeepsTheWeightsOfPointsInsideTheirElements) {
  Pulled pulled(0);
  pulled.points[0] = Vec3::Zero();
  for (std::size_t k = 0; k < 4; ++k)
    pulled.points[0] +=
        pulled.embedding.weights[0][k] * pulled.mesh.nodes[static_cast<std::size_t>(pulled.mesh.tets[0][k])];
  const Spring spring = pulled.active().springs[0];
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(spring.weights[k], pulled.embedding.weights[0][k]);
}

TEST(ActivePulls, LeaveOutWhatDoesNotPull) {
  Pulled pulled(0);
  const auto count = [&](double frame) {
    return active_pulls({pulled.pull}, pulled.points, pulled.embedding, pulled.mesh, frame).size();
  };
  pulled.pull.active = {{2, 3}};
  EXPECT_EQ(count(1), 0u);
  EXPECT_EQ(count(2), 1u);
  pulled.pull.stiffness = {{{2, 0.0, Ease::Linear}, {3, 8.0, Ease::Linear}}};
  EXPECT_EQ(count(2), 0u);
  EXPECT_NEAR(active_pulls({pulled.pull}, pulled.points, pulled.embedding, pulled.mesh, 2.5).at(0).stiffness, 4, 1e-14);
}

}  // namespace
}  // namespace softreel
