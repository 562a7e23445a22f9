// Bodies of whole lattice tetrahedra, weighted by their fill: mass, rigid motion, fall, and convergence in the edge.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/elasticity/mass.h"
#include "core/skinning/embedding.h"
#include "core/skinning/skinning.h"
#include "core/tetmesh/filling/tetrahedralize.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "core/tetmesh/surface/surface_parts.h"
#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/surfaces.h"
#include "tests/support/thin_surfaces.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::exact_params;

ElementMaterial rubber() {
  ElementMaterial material;
  material.youngs_modulus = 1e6;
  material.poisson_ratio = 0.3;
  return material;
}

BodyModel make_body(const SurfaceMesh& surface, const TetrahedralizeParams& params) {
  const Threads threads(1);
  StageTimes times;
  BodyModel model;
  model.name = "body.test";
  model.mesh = tetrahedralize(surface, params, "test", threads, {}, times);
  model.materials.assign(model.mesh.tets.size(), rubber());
  model.surface_points = surface.positions;
  model.embedding = embed_points(surface.positions, vertex_normals(surface, surface.positions), model.mesh, threads);
  return model;
}

BodyModel make_embedded(const SurfaceMesh& surface, double edge) {
  return make_body(surface, {.edge = edge, .mode = TetMode::Embedded});
}

TEST(EmbeddedBody, WeighsWhatItsSolidWeighs) {
  const SurfaceMesh dumbbell = test::make_dumbbell(0.01);
  const BodyModel model = make_embedded(dumbbell, 0.4);
  const NodalMasses masses = lump_masses(model.mesh, model.materials);
  const double mass = std::accumulate(masses.mass.begin(), masses.mass.end(), 0.0);
  EXPECT_NEAR(mass / (1000 * measure_quality(model.mesh, Threads(1)).volume), 1, 1e-12);
  EXPECT_NEAR(mass / (1000 * find_parts(dumbbell).volume()), 1, 1e-6);
  for (const double m : masses.mass) EXPECT_GT(m, 0);
}

TEST(EmbeddedBody, FeelsNoForceWhenItMovesRigidly) {
  const BodyModel model = make_embedded(test::make_sphere(1, 12, Vec3::Zero()), 0.4);
  const ElasticBody body = make_elastic_body(model.mesh, model.materials, Dilatation::Capped);
  const Threads threads(1);
  const Mat3 Q = Eigen::AngleAxisd(2.0, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3> moved;
  for (const Vec3& x : model.mesh.nodes) moved.push_back(Q * x + Vec3(0.3, -2, 1));
  std::vector<Quaternion> rotations(model.mesh.tets.size(), Quaternion::Identity());
  std::vector<Mat3> stresses(model.mesh.tets.size());
  std::vector<Vec3> forces(model.mesh.nodes.size());
  find_rotations(body, RotationMethod::Consistent, moved, rotations, threads);
  find_stresses(body, moved, rotations, stresses, threads);
  gather_forces(body, stresses, forces, threads);
  for (const Vec3& force : forces) EXPECT_LT(force.norm(), 1e-8);  // of E edge^2 = 1.6e5 N
}

TEST(EmbeddedBody, FallsAsImplicitEulerSays) {
  Bench bench(make_embedded(test::make_sphere(1, 12, Vec3::Zero()), 0.4));
  const std::vector<Vec3> rest = bench.simulator.state().positions;
  const double h = 1.0 / 96;
  const int n = 10;
  for (int k = 1; k <= n; ++k) ASSERT_TRUE(bench.simulator.step(k, h).ok());
  const double drop = 9.81 * h * h * n * (n + 1) / 2;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vec3 moved = bench.simulator.state().positions[i] - rest[i];
    EXPECT_LT((moved + Vec3(0, drop, 0)).norm(), 1e-8 * drop);
  }
}

/// Sag of the free end of a bar of 1.2 x 0.3 x 0.3 m under its weight, held over its first 0.2 m.
double find_sag(BodyModel model) {
  std::vector<Index> held, end;
  for (std::size_t v = 0; v < model.surface_points.size(); ++v) {
    if (model.surface_points[v].x() < -0.4 + 1e-9) held.push_back(static_cast<Index>(v));
    if (model.surface_points[v].x() > 0.6 - 1e-9) end.push_back(static_cast<Index>(v));
  }
  model.pins.push_back(testing::make_pin(held));
  SolverParams params;
  params.force_tolerance = 1e-8;
  const Threads threads(1);
  const Embedding embedding = model.embedding;
  const TetMesh mesh = model.mesh;
  const std::vector<Vec3> points = model.surface_points;
  Bench bench(std::move(model), params);
  const StepReport report = bench.simulator.find_equilibrium(1);
  EXPECT_TRUE(report.ok()) << report.culprit;
  const std::vector<Vec3> moved = skin_positions(points, embedding, mesh, bench.simulator.state().positions, threads);
  double sag = 0;
  for (const Index v : end)
    sag += (points[static_cast<std::size_t>(v)] - moved[static_cast<std::size_t>(v)]).y() /
           static_cast<double>(end.size());
  return sag;
}

TEST(EmbeddedBody, SagsAsAConformingOneDoesTheMoreSoTheFinerTheLattice) {
  const SurfaceMesh bar = test::make_box({0.6, 0.15, 0.15}, 12, Vec3::Zero());
  const double reference = find_sag(make_body(bar, {.edge = 0.05}));
  const double coarse = find_sag(make_embedded(bar, 0.2)), fine = find_sag(make_embedded(bar, 0.07));
  EXPECT_GT(reference, 0.005);
  EXPECT_LT(std::abs(fine / reference - 1), 0.5 * std::abs(coarse / reference - 1));
  EXPECT_LT(std::abs(fine / reference - 1), 0.1);
}

TEST(EmbeddedBody, SwingsByAThinRodWithoutTearing) {
  // A rod of a fiftieth of an edge carries almost nothing: the point is that the step is solved and the ball follows.
  const SurfaceMesh dumbbell = test::make_dumbbell(0.01);
  BodyModel model = make_embedded(dumbbell, 0.5);
  std::vector<Index> held;
  for (std::size_t v = 0; v < dumbbell.positions.size(); ++v)
    if (dumbbell.positions[v].x() < -1.5) held.push_back(static_cast<Index>(v));
  model.pins.push_back(testing::make_pin(held));
  Bench bench(std::move(model));
  for (int k = 1; k <= 10; ++k) {
    const StepReport report = bench.simulator.step(k, 1.0 / 96);
    ASSERT_TRUE(report.ok()) << report.culprit;
  }
  for (const Vec3& x : bench.simulator.state().positions) EXPECT_TRUE(x.allFinite());
}

}  // namespace
}  // namespace softreel
