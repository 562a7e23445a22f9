// The vector kernels of a time step against the scalar functions that they stand for.
#include "core/elasticity/step_terms.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "core/elasticity/assembly.h"
#include "core/elasticity/float_assembly.h"
#include "core/sparse/block_kernels.h"
#include "tests/support/bcc_bar.h"

namespace softreel {
namespace {

constexpr double kSeconds = 0.01;

/// A deformed body that moves. The lattice has several slabs, and a number of elements that is no multiple of the
/// lanes.
struct Moving {
  Moving(bool one_material, double noise, bool with_secant = false)
      : secant(with_secant), threads(4), mesh(testing::bcc_bar({8, 6, 5}, 0.1)) {
    mesh.tets.pop_back();
    std::vector<ElementMaterial> materials(mesh.tets.size());
    if (!one_material)
      for (std::size_t e = 0; e < materials.size(); e += 3) materials[e] = {3e5, 0.2, 700, 0, 0};
    body = make_elastic_body(mesh, materials, Dilatation::Capped);
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    const Mat3 turn = Eigen::AngleAxisd(1.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (const Vec3& node : mesh.nodes) {
      positions.push_back(turn * (node + noise * vector()));
      velocities.push_back(vector());
      node_terms.push_back(1 + std::abs(normal(random)));
    }
    EXPECT_GT(body.node_slabs.slab_offsets.size(), 3U);
    rotations.assign(mesh.tets.size(), Quaternion::Identity());
    find_rotations(body, RotationMethod::Consistent, positions, rotations, threads);
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) damping.push_back(0.002 * static_cast<double>(e % 5));
  }

  StepSource source() const {
    return {positions, velocities, rotations, {kSeconds, kSeconds}, damping, {}, -1, {}, secant};
  }

  StepTerms terms(int thread_count) const {
    StepTerms result;
    find_step_terms(body, source(), result, Threads(thread_count));
    return result;
  }

  std::vector<double> shares() const {
    std::vector<double> result;
    for (const double b : damping) result.push_back(kSeconds * (kSeconds + b));
    return result;
  }

  BlockMatrixd matrix(std::span<const double> with_node_terms) const {
    BlockMatrixd result{stiffness_pattern(mesh.tets, static_cast<Index>(mesh.nodes.size())), {}};
    StiffnessTerms stiffness;
    find_stiffness_terms(body, positions, rotations, shares(), Curvature::None, stiffness, threads);
    take_step_slopes(body, source(), stiffness, threads);
    StiffnessAssembler(mesh.tets, result.pattern).assemble(stiffness, with_node_terms, result, threads);
    return result;
  }

  bool secant;
  Threads threads;
  TetMesh mesh;
  ElasticBody body;
  std::vector<Vec3> positions, velocities;
  std::vector<Quaternion> rotations;
  std::vector<double> damping, node_terms;
};

/// h f - (h C + h^2 K) v by the scalar functions and the matrix.
std::vector<Vec3> expected_forces(const Moving& moving) {
  const std::size_t n = moving.mesh.nodes.size();
  std::vector<Mat3> stresses(moving.mesh.tets.size());
  std::vector<Vec3> forces(n), product(n);
  find_stresses(moving.body, moving.positions, moving.rotations, stresses, moving.threads);
  gather_forces(moving.body, stresses, forces, moving.threads);
  BlockMatrixd K = moving.matrix(std::vector<double>(n, 0.0));
  K.values.resize(K.values.size() + 3);  // for the lanes past the last block
  NodeVector<double> v, Kv(4 * n);
  pack(moving.velocities, v);
  multiply(K, v, Kv, moving.threads);
  unpack(Kv, product);
  for (std::size_t i = 0; i < n; ++i) forces[i] = kSeconds * forces[i] - product[i];
  return forces;
}

struct State {
  double noise;
  bool secant;
};
constexpr State kStates[] = {{0.002, false}, {0.05, false}, {0.05, true}};  // 0.05 takes some elements over the cap

TEST(StepTerms, GiveTheForcesOfTheScalarFunctions) {
  for (const bool one_material : {true, false})
    for (const auto& [noise, secant] : kStates) {
      const Moving moving(one_material, noise, secant);
      const std::vector<Vec3> expected = expected_forces(moving);
      std::vector<Vec3> forces(expected.size());
      gather_step_forces(moving.body, moving.terms(1), forces, moving.threads);
      double scale = 0;
      for (const Vec3& f : expected) scale = std::max(scale, f.norm());
      for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_LT((forces[i] - expected[i]).norm(), 1e-12 * scale);
    }
}

std::vector<Vec3> forces_with(const Moving& moving, const StepSource& source) {
  StepTerms terms;
  find_step_terms(moving.body, source, terms, moving.threads);
  std::vector<Vec3> forces(moving.mesh.nodes.size());
  gather_step_forces(moving.body, terms, forces, moving.threads);
  return forces;
}

/// Offsets that are a velocity times seconds.position pass for it where nothing is damped, and know of no damping.
TEST(StepTerms, GoOnFromTheirPositionsByTheOffsets) {
  for (const bool secant : {false, true}) {
    Moving moving(false, 0.05, secant);
    const std::size_t n = moving.mesh.nodes.size();
    std::vector<Vec3> offsets(n);
    const std::vector<Vec3> still(n, Vec3::Zero());
    StepSource damped = moving.source();
    damped.seconds = {kSeconds, 3 * kSeconds};
    for (std::size_t i = 0; i < n; ++i) offsets[i] = damped.seconds.position * moving.velocities[i];
    const std::vector<double> undamped(moving.damping.size(), 0.0);
    StepSource by_velocity = damped;
    by_velocity.damping_stiffness = undamped;
    damped.velocities = still;
    damped.offsets = offsets;
    StepSource by_offset = damped;
    by_offset.damping_stiffness = undamped;
    const std::vector<Vec3> expected = forces_with(moving, by_velocity), forces = forces_with(moving, by_offset),
                            with_damping = forces_with(moving, damped);
    double scale = 0;
    for (const Vec3& f : expected) scale = std::max(scale, f.norm());
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_LT((forces[i] - expected[i]).norm(), 1e-12 * scale);
      EXPECT_LT((with_damping[i] - expected[i]).norm(), 1e-12 * scale);
    }
  }
}

TEST(StepTerms, SumToNoForce) {
  const Moving moving(false, 0.02);
  std::vector<Vec3> forces(moving.mesh.nodes.size());
  gather_step_forces(moving.body, moving.terms(1), forces, moving.threads);
  Vec3 sum = Vec3::Zero();
  double scale = 0;
  for (const Vec3& f : forces) {
    sum += f;
    scale += f.norm();
  }
  EXPECT_LT(sum.norm(), 1e-14 * scale);
}

/// Rows of a permutation of the mesh's nodes, as a hierarchy has them.
std::vector<Index> shuffled_rows(std::size_t nodes) {
  std::vector<Index> row_of_node(nodes);
  std::iota(row_of_node.begin(), row_of_node.end(), 0);
  std::shuffle(row_of_node.begin(), row_of_node.end(), std::mt19937(4));
  return row_of_node;
}

BlockMatrixf assembled_in_float(const Moving& moving, const std::vector<Index>& row_of_node, int thread_count) {
  std::vector<Tet> renumbered = moving.mesh.tets;
  for (Tet& tet : renumbered)
    for (Index& node : tet) node = row_of_node[static_cast<std::size_t>(node)];
  BlockMatrixf matrix{stiffness_pattern(renumbered, static_cast<Index>(row_of_node.size())), {}};
  reserve_values(matrix);
  const FloatAssembler assembler(moving.mesh.tets, moving.body.node_elements, matrix.pattern, row_of_node);
  assembler.assemble(moving.terms(thread_count), moving.node_terms, {}, matrix, Threads(thread_count));
  return matrix;
}

TEST(FloatAssembler, AgreesWithTheAssemblerInDouble) {
  for (const bool one_material : {true, false})
    for (const auto& [noise, secant] : kStates) {
      const Moving moving(one_material, noise, secant);
      EXPECT_EQ(moving.terms(1).uniform_ratio, one_material && noise < 0.01);
      const std::vector<Index> row_of_node = shuffled_rows(moving.mesh.nodes.size());
      const BlockMatrixd expected = moving.matrix(moving.node_terms);
      const BlockMatrixf matrix = assembled_in_float(moving, row_of_node, 1);
      double scale = 0;
      for (const double value : expected.values) scale = std::max(scale, std::abs(value));
      for (std::size_t i = 0; i < row_of_node.size(); ++i)
        for (std::int64_t b = expected.pattern.row_offsets[i]; b < expected.pattern.row_offsets[i + 1]; ++b) {
          const auto j = static_cast<std::size_t>(expected.pattern.column_indices[static_cast<std::size_t>(b)]);
          const float* const block = matrix.block(matrix.pattern.find(row_of_node[i], row_of_node[j]));
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(block[3 * c + r], expected.block(b)[3 * r + c], 1e-6 * scale);
        }
    }
}

TEST(FloatAssembler, IsSymmetricToTheLastBit) {
  for (const double noise : {0.002, 0.05}) {
    const Moving moving(true, noise);
    const BlockMatrixf matrix = assembled_in_float(moving, shuffled_rows(moving.mesh.nodes.size()), 1);
    for (Index i = 0; i < matrix.pattern.rows(); ++i)
      for (std::int64_t b = matrix.pattern.row_offsets[static_cast<std::size_t>(i)];
           b < matrix.pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++b) {
        const std::int64_t mirror = matrix.pattern.find(matrix.pattern.column_indices[static_cast<std::size_t>(b)], i);
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) EXPECT_EQ(matrix.block(b)[3 * r + c], matrix.block(mirror)[3 * c + r]);
      }
  }
}

TEST(StepTerms, HaveTheSameBitsOnOneAndFourThreads) {
  const Moving moving(false, 0.02);
  const std::vector<Index> row_of_node = shuffled_rows(moving.mesh.nodes.size());
  EXPECT_EQ(assembled_in_float(moving, row_of_node, 1).values, assembled_in_float(moving, row_of_node, 4).values);
  const StepTerms one = moving.terms(1), four = moving.terms(4);
  std::vector<Vec3> a(moving.mesh.nodes.size()), b(a.size());
  gather_step_forces(moving.body, one, a, Threads(1));
  gather_step_forces(moving.body, four, b, Threads(4));
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace softreel
