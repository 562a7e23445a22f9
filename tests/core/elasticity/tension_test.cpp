// The stiffness of tension in a step's matrix and right side, and what decides whether a step needs it.
#include "core/elasticity/tension.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/elasticity/assembly.h"
#include "core/elasticity/float_assembly.h"
#include "core/elasticity/thickness.h"
#include "core/sparse/block_kernels.h"
#include "tests/support/bcc_bar.h"

namespace softreel {
namespace {

constexpr StepSeconds kStep{0.01, 0.02};

/// A lattice that is stretched along x, turned, disturbed and in motion, of several slabs.
struct Taut {
  explicit Taut(double stretch, Dilatation dilatation = Dilatation::Capped)
      : threads(4), mesh(testing::bcc_bar({8, 6, 5}, 0.1)) {
    mesh.tets.pop_back();  // no multiple of the lanes
    materials.assign(mesh.tets.size(), {1e5, 0.3, 1000, 0, 0});
    for (std::size_t e = 0; e < materials.size(); e += 3) materials[e].youngs_modulus = 3e5;
    body = make_elastic_body(mesh, materials, dilatation);
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(3, 1, 2).normalized()).toRotationMatrix();
    for (const Vec3& node : mesh.nodes) {
      positions.push_back(turn * (node.cwiseProduct(Vec3(stretch, 1, 1)) + 0.005 * vector()));
      velocities.push_back(vector());
      offsets.push_back(0.01 * vector());
    }
    rotations.assign(mesh.tets.size(), Quaternion::Identity());
    find_rotations(body, RotationMethod::Consistent, positions, rotations, threads);
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) damping.push_back(0.002 * static_cast<double>(e % 5));
    limits.assign(kElementLanes * body.batches.size(), std::numeric_limits<double>::infinity());
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) limits[e] = e % 7 == 0 ? 0.0 : 100.0;
  }

  StepSource source() const { return {positions, velocities, rotations, kStep, damping, offsets, -1, limits}; }

  std::vector<Vec3> forces(const StepSource& from, StepTerms& terms) const {
    std::vector<Vec3> found(mesh.nodes.size());
    find_step_terms(body, from, terms, threads);
    gather_step_forces(body, terms, found, threads);
    return found;
  }

  Threads threads;
  TetMesh mesh;
  std::vector<ElementMaterial> materials;
  ElasticBody body;
  std::vector<Vec3> positions, velocities, offsets;
  std::vector<Quaternion> rotations;
  std::vector<double> damping;
  AlignedVector<double> limits;
};

Mat3 cross_matrix(const Vec3& v) {
  return (Mat3() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

/// -t V sum_j [a_i]x C [a_j]x^T (r v_j + o_j) of all elements, C = tension_curvature.
std::vector<Vec3> expected_tension_forces(const Taut& taut) {
  std::vector<Vec3> forces(taut.mesh.nodes.size(), Vec3::Zero());
  for (std::size_t e = 0; e < taut.mesh.tets.size(); ++e) {
    const Tet& tet = taut.mesh.tets[e];
    const ElementShape& shape = taut.body.shapes[e];
    const Mat3 Q = taut.rotations[e].toRotationMatrix();
    const Mat3 F = deformation_gradient(shape.gradients, nodes_of(tet, taut.positions));
    const Mat3 C =
        tension_curvature(taut.body.laws[e], Q, F, taut.limits[e] / std::sqrt(kStep.velocity * kStep.position));
    const Gradients a = Q * shape.gradients;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const auto node = static_cast<std::size_t>(tet[static_cast<std::size_t>(j)]);
        const Vec3 way = kStep.position * taut.velocities[node] + taut.offsets[node];
        forces[static_cast<std::size_t>(tet[static_cast<std::size_t>(i)])] -=
            kStep.velocity * shape.volume * (cross_matrix(a.col(i)) * C * cross_matrix(a.col(j)).transpose() * way);
      }
  }
  return forces;
}

TEST(TensionCurvature, IsThePositivePartAboveTheLimit) {
  const ElasticLaw law{3, 1, true};
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0, 0.4);
  for (int k = 0; k < 50; ++k) {
    Mat3 stretch = Mat3::Identity();
    for (int i = 0; i < 9; ++i) stretch(i / 3, i % 3) += normal(random);
    const Mat3 U = 0.5 * (stretch + stretch.transpose());
    const Mat3 Q = Eigen::AngleAxisd(k, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const Mat3 whole = rotation_curvature(law, Q, Q * U, true);
    EXPECT_LT((tension_curvature(law, Q, Q * U, 0) - whole).norm(), 1e-12 * (1 + whole.norm()));
    const Eigen::SelfAdjointEigenSolver<Mat3> all(whole);
    const Eigen::SelfAdjointEigenSolver<Mat3> above(tension_curvature(law, Q, Q * U, 0.4));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(above.eigenvalues()[i], std::max(all.eigenvalues()[i] - 0.2, 0.0), 1e-12);
  }
}

TEST(TensionCurvature, OfAStringIsItsTension) {
  // Uniaxial stress: turned about an axis across, a length L under the force T per area resists by T / 2 on each of
  // kappa's two places; about its own axis not at all.
  const ElasticLaw law{1.2, 1, true};
  const double s = 1.5, across = 1 - law.lambda / (2 * (law.lambda + law.mu)) * (s - 1);
  const Mat3 F = Vec3(s, across, across).asDiagonal();
  const double T = corotated_stress(law, Mat3::Identity(), F)(0, 0);
  const Mat3 C = tension_curvature(law, Mat3::Identity(), F, 0);
  EXPECT_NEAR(C(0, 0), 0, 1e-12);
  EXPECT_NEAR(2 * C(1, 1), T / (s + across), 1e-12);
  EXPECT_NEAR(2 * C(2, 2), T / (s + across), 1e-12);
}

TEST(StepTension, HasTheForcesOfItsScalarTwin) {
  for (const double stretch : {1.05, 1.5, 4.0})
    for (const Dilatation dilatation : {Dilatation::Capped, Dilatation::Linear}) {
      const Taut taut(stretch, dilatation);
      StepSource without = taut.source();
      without.tension_limits = {};
      StepTerms terms, plain;
      const std::vector<Vec3> with = taut.forces(taut.source(), terms), base = taut.forces(without, plain),
                              expected = expected_tension_forces(taut);
      double scale = 0, greatest = 0;
      for (std::size_t i = 0; i < base.size(); ++i) {
        scale = std::max(scale, base[i].norm());
        greatest = std::max(greatest, expected[i].norm());
      }
      EXPECT_GT(greatest, 1e-3 * scale) << "or nothing is compared";
      for (std::size_t i = 0; i < base.size(); ++i)
        EXPECT_LT((with[i] - base[i] - expected[i]).norm(), 1e-11 * scale) << stretch;
    }
}

TEST(StepTension, HasTheMatrixOfItsScalarTwinInFloat) {
  const Taut taut(1.5);
  const std::size_t n = taut.mesh.nodes.size();
  StepTerms terms;
  taut.forces(taut.source(), terms);
  std::vector<double> shares;
  for (const double b : taut.damping) shares.push_back(kStep.velocity * (kStep.position + b));
  StiffnessTerms stiffness;
  find_stiffness_terms(taut.body, taut.positions, taut.rotations, shares, Curvature::None, stiffness, taut.threads);
  take_step_slopes(taut.body, taut.source(), stiffness, taut.threads);
  stiffness.curvatures = find_tension_curvatures(taut.body, taut.source(), taut.threads);
  ASSERT_EQ(stiffness.curvatures.size(), taut.mesh.tets.size());
  BlockMatrixd expected{stiffness_pattern(taut.mesh.tets, static_cast<Index>(n)), {}};
  const std::vector<double> node_terms(n, 1.0);
  StiffnessAssembler(taut.mesh.tets, expected.pattern).assemble(stiffness, node_terms, expected, taut.threads);
  BlockMatrixf matrix{expected.pattern, {}};
  reserve_values(matrix);
  std::vector<Index> rows(n);
  std::iota(rows.begin(), rows.end(), 0);
  FloatAssembler(taut.mesh.tets, taut.body.node_elements, matrix.pattern, rows)
      .assemble(terms, node_terms, {}, matrix, taut.threads);
  double scale = 0;
  for (const double value : expected.values) scale = std::max(scale, std::abs(value));
  for (Index i = 0; i < matrix.pattern.rows(); ++i)
    for (std::int64_t b = matrix.pattern.row_offsets[static_cast<std::size_t>(i)];
         b < matrix.pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++b) {
      const std::int64_t mirror = matrix.pattern.find(matrix.pattern.column_indices[static_cast<std::size_t>(b)], i);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(matrix.block(b)[3 * c + r], expected.block(b)[3 * r + c], 1e-6 * scale);
          EXPECT_EQ(matrix.block(b)[3 * r + c], matrix.block(mirror)[3 * c + r]);
        }
    }
}

TEST(StepTension, IsNoGreaterThanAtTheStepsStart) {
  const Taut taut(1.5), less(1.2);
  Taut still(1.5);
  still.positions = still.mesh.nodes;
  still.rotations.assign(still.rotations.size(), Quaternion::Identity());
  const auto curvatures = [&](const Taut& at, const Taut* start) {
    StepSource source = at.source();
    if (start != nullptr) source.start_positions = start->positions, source.start_rotations = start->rotations;
    const std::vector<Mat3> found = find_tension_curvatures(at.body, source, at.threads);
    StepTerms terms;
    at.forces(source, terms);
    for (std::size_t e = 0; e < found.size(); ++e) {  // and the vector twin
      const float* rows = terms.curvature_of(e);
      for (int k = 0; k < 9; ++k)
        EXPECT_NEAR(rows == nullptr ? 0.0f : rows[4 * (k / 3) + k % 3], found[e](k / 3, k % 3), 1e-5) << e;
    }
    return found;
  };
  const auto greatest = [](const Mat3& C) { return Eigen::SelfAdjointEigenSolver<Mat3>(C).eigenvalues()[2]; };
  const std::vector<Mat3> plain = curvatures(taut, nullptr), from_itself = curvatures(taut, &taut),
                          from_less = curvatures(taut, &less), of_less = curvatures(less, nullptr),
                          from_more = curvatures(less, &taut);
  for (std::size_t e = 0; e < plain.size(); ++e) {
    EXPECT_LT((from_itself[e] - plain[e]).norm(), 1e-12);
    EXPECT_LE(greatest(from_less[e]), std::min(greatest(plain[e]), greatest(of_less[e])) + 1e-12);
    EXPECT_LE(greatest(from_more[e]), std::min(greatest(plain[e]), greatest(of_less[e])) + 1e-12);
  }
  EXPECT_GT(greatest(from_less[0]), 0.9 * greatest(of_less[0])) << "or nothing is left of it";
  for (const Mat3& C : curvatures(taut, &still)) EXPECT_LT(C.norm(), 1e-12) << "a body at rest has none";
}

TEST(StepTension, TakesNoMemoryFromACalmBodyAndGivesItBack) {
  const Taut taut(1.5), calm(1.0);
  const auto slabs_with = [](const StepTerms& terms) {
    return std::count_if(terms.curvatures.begin(), terms.curvatures.end(), [](const auto& s) { return !s.empty(); });
  };
  StepTerms terms;
  taut.forces(taut.source(), terms);
  EXPECT_EQ(slabs_with(terms), static_cast<std::ptrdiff_t>(terms.curvatures.size()));
  AlignedVector<double> high(calm.limits.size(), 1e9);
  StepSource source = calm.source();
  source.tension_limits = high;
  const std::vector<Vec3> after = calm.forces(source, terms);
  EXPECT_EQ(slabs_with(terms), 0);
  EXPECT_TRUE(find_tension_curvatures(calm.body, source, calm.threads).empty());
  source.tension_limits = {};
  StepTerms fresh;
  EXPECT_EQ(after, calm.forces(source, fresh)) << "a calm body has the bits of one without limits";
}

TEST(StepTension, HasTheSameBitsOnOneAndFourThreads) {
  const Taut taut(1.5);
  StepTerms one, four;
  find_step_terms(taut.body, taut.source(), one, Threads(1));
  find_step_terms(taut.body, taut.source(), four, Threads(4));
  EXPECT_EQ(one.curvatures, four.curvatures);
  EXPECT_EQ(one.forces, four.forces);
}

/// find_thickness of a bar of cubes of 0.1 m, of one material.
std::vector<double> thickness_of(const TetMesh& mesh, const std::vector<double>& moduli) {
  return find_thickness(mesh, stiffness_pattern(mesh.tets, static_cast<Index>(mesh.nodes.size())), moduli);
}

TEST(Thickness, OfABarIsItsDepthNearlyEverywhere) {
  for (const int cells : {2, 4, 8}) {
    const TetMesh mesh = testing::kuhn_bar({6 * cells, cells, cells}, Vec3(0.6, 0.1, 0.1) * cells);
    const std::vector<double> thickness = thickness_of(mesh, std::vector<double>(mesh.tets.size(), 1e5));
    for (const double d : thickness) EXPECT_LE(d, 0.1 * cells + 1e-12) << "more would leave out what is harmful";
    const double mean =
        std::accumulate(thickness.begin(), thickness.end(), 0.0) / static_cast<double>(thickness.size());
    EXPECT_GT(mean, 0.095 * cells);
  }
}

TEST(Thickness, OfASheetOfOneLayerIsAnElementsLeastHeight) {
  const TetMesh mesh = testing::kuhn_bar({10, 10, 1}, Vec3(1, 1, 0.1));
  for (const double d : thickness_of(mesh, std::vector<double>(mesh.tets.size(), 1e5))) {
    EXPECT_LE(d, 0.1 + 1e-12);
    EXPECT_GE(d, 0.05);
  }
}

TEST(Thickness, OfAStiffCoreIsItsOwn) {
  const TetMesh mesh = testing::kuhn_bar({24, 8, 8}, Vec3(2.4, 0.8, 0.8));
  const auto is_core = [&](const Tet& tet) {
    const TetNodes x = nodes_of(tet, mesh.nodes);
    const Vec3 c = 0.25 * (x[0] + x[1] + x[2] + x[3]);
    return std::abs(c.y() - 0.4) < 0.1 && std::abs(c.z() - 0.4) < 0.1;
  };
  std::vector<double> moduli;
  for (const Tet& tet : mesh.tets) moduli.push_back(is_core(tet) ? 1e8 : 1e5);
  const std::vector<double> thickness = thickness_of(mesh, moduli);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    if (is_core(mesh.tets[e])) {
      EXPECT_LE(thickness[e], 0.2 + 1e-12);
    }
}

}  // namespace
}  // namespace softreel
