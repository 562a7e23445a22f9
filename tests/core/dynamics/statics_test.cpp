#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/constraints/pins.h"
#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;
using testing::exact_params;
using testing::greatest_distance;

constexpr double kHalfTurn = EIGEN_PI;

ElementMaterial rubber(double poisson_ratio = 0.3) {
  ElementMaterial material;
  material.youngs_modulus = 1e6;
  material.poisson_ratio = poisson_ratio;
  return material;
}

std::vector<Index> plane_x(const TetMesh& mesh, double x) {
  return testing::select_nodes(mesh, [x](const Vec3& p) { return std::abs(p.x() - x) < 1e-9; });
}

TetMesh cubed_bar() {
  return testing::kuhn_bar({6, 3, 3}, Vec3(0.6, 0.3, 0.3));
}

std::vector<Vec3> transformed(const Transform& transform, std::vector<Vec3> points) {
  for (Vec3& point : points) point = transform.apply(point);
  return points;
}

TEST(FindEquilibrium, KeepsAFreeBodyAtRestWhereItIs) {
  BodyModel model = body_model(cubed_bar(), rubber());
  model.gravity.setZero();
  Bench bench(model, exact_params());
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.culprit;
  EXPECT_LT(greatest_distance(bench.simulator.state().positions, model.mesh.nodes), 1e-14);
}

TEST(FindEquilibrium, RelaxesAFreeBodyAboutItsCentreOfMass) {
  BodyModel model = body_model(cubed_bar(), rubber());
  model.gravity.setZero();
  Bench bench(model, exact_params());
  SimulationState state = bench.simulator.state();
  for (Vec3& p : state.positions) p = Vec3(3, 0, 0) + Vec3(1.3 * p.x(), p.y() + 0.1 * p.x() * p.x(), p.z());
  const std::vector<Vec3> start = state.positions;
  bench.simulator.set_state(state);
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.culprit;
  EXPECT_LT(bench.simulator.measure().elastic_energy, 1e-12);
  Vec3 before = Vec3::Zero(), after = Vec3::Zero();
  for (const Tet& tet : model.mesh.tets)  // elements of equal volume: this sum weighs nodes by mass
    for (const Index node : tet) {
      before += start[static_cast<std::size_t>(node)];
      after += bench.simulator.state().positions[static_cast<std::size_t>(node)];
    }
  EXPECT_LT((after - before).norm(), 1e-12 * before.norm());
}

/// A rigid motion of all pins moves the body rigidly, by any angle.
class RigidPins : public ::testing::TestWithParam<double> {};

TEST_P(RigidPins, MoveTheBodyRigidly) {
  for (const bool both_ends : {false, true})
    for (const RotationMethod rotation : {RotationMethod::Consistent, RotationMethod::Energy, RotationMethod::Paper,
                                          RotationMethod::PolarSmooth, RotationMethod::Qr}) {
      BodyModel model = body_model(cubed_bar(), rubber());
      model.gravity.setZero();
      Transform motion;
      motion.translate = Vec3(1, -2, 0.5);
      motion.rotate = Vec3(0.3 * GetParam(), GetParam(), 0);
      motion.pivot = Vec3(0.1, 0, 0);
      std::vector<Index> points = plane_x(model.mesh, 0);
      if (both_ends)
        for (const Index point : plane_x(model.mesh, 0.6)) points.push_back(point);
      model.pins = {testing::make_pin(points, motion)};
      SolverParams params = exact_params();
      params.rotation = rotation;
      Bench bench(model, params);
      const StepReport report = bench.simulator.find_equilibrium(1);
      ASSERT_TRUE(report.ok()) << report.culprit;
      EXPECT_LT(greatest_distance(bench.simulator.state().positions, transformed(motion, model.mesh.nodes)),
                1e-9 * 0.74);
    }
}

INSTANTIATE_TEST_SUITE_P(Angles, RigidPins,
                         ::testing::Values(0.0, 0.5, 0.5 * kHalfTurn, kHalfTurn, 1.5 * kHalfTurn, 7.0));

TEST(FindEquilibrium, PassesThePatchTest) {
  // An affine motion of the boundary reproduces itself inside: F is the same in every element.
  for (const bool lattice : {false, true}) {
    const TetMesh mesh = lattice ? testing::bcc_bar({5, 5, 5}, 0.1) : testing::kuhn_bar({6, 6, 6}, Vec3(0.6, 0.5, 0.4));
    BodyModel model = body_model(mesh, rubber(0.4));
    model.gravity.setZero();
    Transform affine;
    affine.rotate = Vec3(0.4, -0.2, 1.1);
    affine.scale = Vec3(1.15, 0.95, 1.05);
    std::vector<Index> boundary;
    for (const Triangle& face : boundary_faces(model.mesh)) boundary.insert(boundary.end(), face.begin(), face.end());
    model.pins = {testing::make_pin(boundary, affine)};
    ASSERT_LT(NodePins(model.pins, model.embedding, model.mesh).at(1).count, static_cast<Index>(mesh.nodes.size()));
    Bench bench(model, exact_params());
    const StepReport report = bench.simulator.find_equilibrium(1);
    ASSERT_TRUE(report.ok()) << report.culprit;
    EXPECT_LT(greatest_distance(bench.simulator.state().positions, transformed(affine, model.mesh.nodes)), 1e-11);
  }
}

TEST(FindEquilibrium, PassesThePatchTestToRoundOffOnAnIrregularMesh) {
  TetMesh mesh = testing::kuhn_bar({5, 5, 5}, Vec3(0.5, 0.45, 0.4));
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-0.02, 0.02);
  for (Vec3& node : mesh.nodes) node += Vec3(uniform(random), uniform(random), uniform(random));
  BodyModel model = body_model(mesh, rubber(0.4));
  model.gravity.setZero();
  Transform affine;
  affine.rotate = Vec3(0.4, -0.2, 1.1);
  affine.scale = Vec3(1.1, 0.95, 1.05);
  std::vector<Index> boundary;
  for (const Triangle& face : boundary_faces(mesh)) boundary.insert(boundary.end(), face.begin(), face.end());
  model.pins = {testing::make_pin(boundary, affine)};
  ASSERT_LT(NodePins(model.pins, model.embedding, mesh).at(1).count, static_cast<Index>(mesh.nodes.size()));
  SolverParams params = exact_params();
  params.force_tolerance = 1e-15;
  Bench bench(model, params);
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.culprit;
  EXPECT_LT(greatest_distance(bench.simulator.state().positions, transformed(affine, mesh.nodes)), 1e-12);
}

TEST(FindEquilibrium, StretchesStiffAndSoftHalvesInSeriesByTheirStiffness) {
  // nu = 0: the bar stays uniaxial, so the soft half takes 4/5 of the elongation.
  BodyModel model = body_model(testing::kuhn_bar({8, 2, 2}, Vec3(0.8, 0.2, 0.2)), rubber(0));
  model.gravity.setZero();
  for (std::size_t e = 0; e < model.mesh.tets.size(); ++e) {
    if (testing::centroid(model.mesh, e).x() > 0.4) model.materials[e].youngs_modulus *= 4;
  }
  // Surface points at the elements' centroids, so that pins hold whole layers of cells: 0.1 m at either end.
  model.surface_points.clear();
  model.embedding = {};
  for (std::size_t e = 0; e < model.mesh.tets.size(); ++e) {
    model.surface_points.push_back(testing::centroid(model.mesh, e));
    model.embedding.elements.push_back(static_cast<Index>(e));
    model.embedding.weights.push_back({0.25, 0.25, 0.25, 0.25});
  }
  const auto elements_between = [&](double from, double to) {
    std::vector<Index> elements;
    for (std::size_t e = 0; e < model.mesh.tets.size(); ++e)
      if (model.surface_points[e].x() > from && model.surface_points[e].x() < to)
        elements.push_back(static_cast<Index>(e));
    return elements;
  };
  Transform away;
  away.translate.x() = 0.06;
  model.pins = {testing::make_pin(elements_between(0, 0.1)), testing::make_pin(elements_between(0.7, 0.8), away)};
  Bench bench(model, exact_params());
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.culprit;
  // 0.3 m of either material between the held layers.
  const double strain_of_soft = 0.06 / (0.3 + 0.3 / 4);
  for (std::size_t i = 0; i < model.mesh.nodes.size(); ++i) {
    const double x = model.mesh.nodes[i].x();
    const double expected = strain_of_soft * (std::clamp(x - 0.1, 0.0, 0.3) + std::clamp(x - 0.4, 0.0, 0.3) / 4);
    EXPECT_NEAR(bench.simulator.state().positions[i].x() - x, expected, 1e-12);
  }
}

TEST(FindEquilibrium, HangsAStiffBodyOnSpringsWhereTheyBalanceItsWeight) {
  BodyModel model = body_model(cubed_bar(), rubber());
  for (ElementMaterial& material : model.materials) material.youngs_modulus = 1e9;
  const double weight = 1000 * 0.6 * 0.3 * 0.3 * 9.81, stiffness = 1e4;
  model.pulls = {testing::make_pull(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.y() > 0.299; }), {},
                                    stiffness)};
  Bench bench(model);
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.culprit;
  double sag = 0;
  for (const Index point : model.pulls[0].points)
    sag += bench.simulator.state().positions[static_cast<std::size_t>(point)].y() - 0.3;
  EXPECT_NEAR(sag / static_cast<double>(model.pulls[0].points.size()), -weight / stiffness, 1e-4 * weight / stiffness);
}

TEST(FindEquilibrium, BendsACantileverLikeTimoshenkoWithRefinement) {
  // A gently loaded cantilever of 1 x 0.25 x 0.25 m: w = q L^4 / (8 E I) + q L^2 / (2 kappa G A), kappa = 5/6.
  // nu = 0 keeps the clamped end free of stress peaks that beam theory lacks.
  const double length = 1, width = 0.25, gravity = 0.02, E = 1e6;
  const double load = 1000 * width * width * gravity, inertia = std::pow(width, 4) / 12;
  std::vector<double> errors;
  for (const int cells : {2, 4, 8}) {
    BodyModel model = body_model(testing::kuhn_bar({4 * cells, cells, cells}, Vec3(length, width, width)), rubber(0));
    model.gravity = Vec3(0, -gravity, 0);
    // One point at the end face's every node would hold the first layer of cells: the free length starts after it.
    model.pins = {testing::make_pin(plane_x(model.mesh, 0))};
    Bench bench(model);
    const StepReport report = bench.simulator.find_equilibrium(1);
    ASSERT_TRUE(report.ok()) << report.culprit;
    const double free = length - width / cells;
    const double expected =
        load * std::pow(free, 4) / (8 * E * inertia) + load * free * free / (2 * (5.0 / 6.0) * (E / 2) * width * width);
    double tip = 0;
    const std::vector<Index> end = plane_x(model.mesh, length);
    for (const Index node : end)
      tip -= bench.simulator.state().positions[static_cast<std::size_t>(node)].y() -
             model.mesh.nodes[static_cast<std::size_t>(node)].y();
    tip /= static_cast<double>(end.size());
    errors.push_back(std::abs(tip / expected - 1));
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 0.8);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.2);
  EXPECT_LT(errors[2], 0.1);
  RecordProperty("errors",
                 std::to_string(errors[0]) + " " + std::to_string(errors[1]) + " " + std::to_string(errors[2]));
}

TEST(FindEquilibrium, HoldsAHalfTurnOfTwist) {
  BodyModel model = body_model(testing::kuhn_bar({12, 3, 3}, Vec3(1, 0.25, 0.25)), rubber());
  model.gravity.setZero();
  Transform turn;
  turn.rotate.x() = kHalfTurn;
  turn.pivot = Vec3(0, 0.125, 0.125);
  model.pins = {testing::make_pin(plane_x(model.mesh, 0)), testing::make_pin(plane_x(model.mesh, 1), turn)};
  Bench bench(model, exact_params());
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.culprit;
  EXPECT_LT(report.nonlinear_iterations, 60);
}

/// Newton iterations to twist a bar by 270 degrees in nine frames; each frame has to be found.
int iterations_of_a_twist(RotationMethod rotation) {
  BodyModel model = body_model(testing::kuhn_bar({12, 3, 3}, Vec3(1, 0.25, 0.25)), rubber(0.4));
  model.gravity.setZero();
  Transform start, turn;
  start.pivot = turn.pivot = Vec3(0, 0.125, 0.125);
  turn.rotate.x() = 1.5 * kHalfTurn;
  model.pins = {testing::make_pin(plane_x(model.mesh, 0)),
                {"body.bar.pin[1]", plane_x(model.mesh, 1), {{{0, start, Ease::Linear}, {9, turn, Ease::Linear}}}, {}}};
  SolverParams params;
  params.rotation = rotation;
  Bench bench(model, params);
  int iterations = 0;
  for (int frame = 1; frame <= 9; ++frame) {
    const StepReport report = bench.simulator.find_equilibrium(frame);
    EXPECT_TRUE(report.ok()) << frame << " " << report.culprit;
    iterations += report.nonlinear_iterations;
  }
  return iterations;
}

TEST(FindEquilibrium, TakesNoMoreIterationsWhereTheRotationHasNoEnergy) {
  // The tangent of the consistent rotation in its place takes half as many again and more.
  const int consistent = iterations_of_a_twist(RotationMethod::Consistent);
  for (const RotationMethod rotation :
       {RotationMethod::Energy, RotationMethod::Paper, RotationMethod::PolarSmooth, RotationMethod::Qr})
    EXPECT_LT(iterations_of_a_twist(rotation), 1.2 * consistent);
}

TEST(FindEquilibrium, FindsTheSameShapeFromAboveAndBelow) {
  BodyModel model = body_model(cubed_bar(), rubber());
  model.pins = {testing::make_pin(plane_x(model.mesh, 0))};
  Bench rest(model, exact_params()), bent(model, exact_params());
  SimulationState state = bent.simulator.state();
  for (Vec3& p : state.positions) p.y() += 0.4 * p.x() * p.x();
  bent.simulator.set_state(state);
  ASSERT_TRUE(rest.simulator.find_equilibrium(1).ok());
  ASSERT_TRUE(bent.simulator.find_equilibrium(1).ok());
  EXPECT_LT(greatest_distance(rest.simulator.state().positions, bent.simulator.state().positions), 1e-9);
}

TEST(FindEquilibrium, StaysAtRestInDynamics) {
  BodyModel model = body_model(cubed_bar(), rubber());
  model.pins = {testing::make_pin(plane_x(model.mesh, 0))};
  Bench bench(model, exact_params());
  ASSERT_TRUE(bench.simulator.find_equilibrium(1).ok());
  const std::vector<Vec3> start = bench.simulator.state().positions;
  for (int k = 1; k <= 3; ++k) ASSERT_TRUE(bench.simulator.step(k, 1.0 / 24).ok());
  EXPECT_LT(greatest_distance(bench.simulator.state().positions, start), 1e-10);
}

TEST(FindEquilibrium, LetsABodyOnOneSpringSwingDownBelowIt) {
  BodyModel model = body_model(cubed_bar(), rubber());
  model.gravity = Vec3(0, -1, 0);
  model.pulls = {testing::make_pull({0}, {}, 1e4)};
  SolverParams params;
  params.force_tolerance = 1e-9;
  Bench bench(model, params);
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.culprit;
  const double weight = 1000 * 0.6 * 0.3 * 0.3;
  const Vec3 held = bench.simulator.state().positions[0];
  EXPECT_NEAR(held.y(), -weight / 1e4, 1e-6);
  Vec3 center = Vec3::Zero();  // equal volumes: each element counts alike
  for (const Tet& tet : model.mesh.tets)
    for (const Index node : tet) center += bench.simulator.state().positions[static_cast<std::size_t>(node)];
  center /= 4.0 * static_cast<double>(model.mesh.tets.size());
  EXPECT_LT(std::hypot(center.x() - held.x(), center.z() - held.z()), 1e-5);
  EXPECT_LT(center.y(), held.y() - 0.3);
}

TEST(FindEquilibrium, FindsABuckledShapeUnderHeavyCompression) {
  BodyModel model = body_model(testing::kuhn_bar({12, 3, 3}, Vec3(1, 0.25, 0.25)), rubber());
  model.gravity.setZero();
  Transform push;
  push.translate.x() = -0.3;
  model.pins = {testing::make_pin(plane_x(model.mesh, 0)), testing::make_pin(plane_x(model.mesh, 1), push)};
  Bench bench(model);
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.culprit;
  EXPECT_LE(report.solve.residual, SolverParams{}.force_tolerance);
}

TEST(FindEquilibrium, FindsWhereAHeavyBodyHangsFromPinsThatStay) {
  // A soft column that falls over. Rounding, which moves the pins of an irregular mesh by a bit, is no motion to take
  // in smaller steps.
  TetMesh mesh = testing::kuhn_bar({3, 12, 3}, Vec3(0.25, 1, 0.25));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  for (Vec3& node : mesh.nodes) node += Vec3(uniform(random), node.y() > 0 ? uniform(random) : 0.0, uniform(random));
  BodyModel model = body_model(mesh, rubber());
  for (ElementMaterial& material : model.materials) material.youngs_modulus = 1e5;
  const std::vector<Index> foot = testing::select_nodes(mesh, [](const Vec3& p) { return p.y() < 1e-9; });
  model.pins = {testing::make_pin(foot)};
  Bench bench(model);
  const StepReport report = bench.simulator.find_equilibrium(1);
  ASSERT_TRUE(report.ok()) << report.nonlinear_iterations << " " << report.solve.residual;
  const std::vector<Vec3>& positions = bench.simulator.state().positions;
  for (const Index node : foot)
    EXPECT_EQ(positions[static_cast<std::size_t>(node)], mesh.nodes[static_cast<std::size_t>(node)]);
  double lowest = 0;
  for (const Vec3& p : positions) lowest = std::min(lowest, p.y());
  EXPECT_LT(lowest, -0.5) << "it hangs";
}

TEST(FindEquilibrium, SaysThatAnUnheldBodyFallsForEver) {
  Bench bench(body_model(cubed_bar(), rubber()));
  try {
    bench.simulator.find_equilibrium(3);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    const std::string message = error.what();
    for (const char* part : {"body.bar", "frame 3", "falls for ever", "Accepted", "Add a pin"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace softreel
