#include <cmath>
#include <functional>
#include <numbers>
#include <ostream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/constraints/pins.h"
#include "core/elasticity/mass.h"
#include "tests/benchmark/steppers/descent_memory.h"
#include "tests/benchmark/steppers/stepper.h"
#include "tests/core/dynamics/dynamics_support.h"

namespace softreel::bench {
namespace {

using namespace softreel::testing;

constexpr double kStep = 1.0 / 48;

/// Nothing that the rivals do not have: no cap, no recovery, no rest.
SolverParams euler_params() {
  SolverParams params = exact_params();
  params.dilatation = Dilatation::Linear;
  params.rest_tolerance = 0;
  params.recovery = false;
  return params;
}

struct Method {
  const char* name;
  std::function<std::unique_ptr<Stepper>(BodyModel, const Threads&)> make;
  int substeps = 1;         ///< of implicit Euler, in a step
  double static_error = 0;  ///< of its static equilibrium, over the largest displacement, at most
};

std::ostream& operator<<(std::ostream& out, const Method& method) {
  return out << method.name;
}

Method direct(const char* name, DirectSolver solver) {
  return {name, [solver](BodyModel m, const Threads&) { return make_direct(std::move(m), euler_params(), solver); }, 1,
          1e-4};
}

Method xpbd(const char* name, const XpbdParams& params, double static_error) {
  return {name, [params](BodyModel m, const Threads&) { return make_xpbd(std::move(m), params); }, params.substeps,
          static_error};
}

/// XPBD's errors are those of its steps (below: of second order), those of projective dynamics fall with its
/// iterations.
const std::vector<Method>& methods() {
  static const std::vector<Method> all{
      {"Softreel",
       [](BodyModel m, const Threads& threads) { return make_softreel(std::move(m), euler_params(), threads); }, 1,
       1e-4},
      direct("EigenLdlt", DirectSolver::EigenLdlt),
      direct("Cholmod", DirectSolver::Cholmod),
      direct("EigenCg", DirectSolver::EigenCgIncompleteCholesky),
      direct("EigenCgJacobi", DirectSolver::EigenCgDiagonal),
      xpbd("XpbdSmallSteps", {50, 1}, 2e-3),
      xpbd("XpbdIterated", {10, 10}, 5e-3),
      {"Projective", [](BodyModel m, const Threads&) { return make_projective_dynamics(std::move(m), {60}); }, 1, 1e-3},
      {"ProjectiveWithMemory",
       [](BodyModel m, const Threads&) {
         return make_projective_dynamics(std::move(m), {20, 5});
       },
       1, 1e-3},
  };
  return all;
}

BodyModel bar(const ElementMaterial& material) {
  BodyModel model = body_model(kuhn_bar({6, 2, 2}, Vec3(0.6, 0.2, 0.2)), material);
  model.gravity.setZero();
  return model;
}

std::vector<Index> root(const BodyModel& model) {
  return select_nodes(model.mesh, [](const Vec3& x) { return x.x() < 1e-9; });
}
std::vector<Index> end_nodes(const BodyModel& model) {
  return select_nodes(model.mesh, [](const Vec3& x) { return x.x() > 0.6 - 1e-9; });
}

double distance(std::span<const Vec3> a, std::span<const Vec3> b) {
  double greatest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) greatest = std::max(greatest, (a[i] - b[i]).norm());
  return greatest;
}

/// Its weight bends it by 3 % of its length; damped so that a few seconds bring it to rest.
BodyModel hanging_bar() {
  BodyModel model = bar({1e5, 0.3, 1000, 6, 0});
  model.gravity = Vec3(0, -1, 0);
  model.pins = {make_pin(root(model))};
  return model;
}

class AnyStepper : public ::testing::TestWithParam<Method> {
 protected:
  /// Null where the method's library is missing.
  std::unique_ptr<Stepper> make(const BodyModel& model) { return GetParam().make(model, threads_); }
  Threads threads_{1};
};

constexpr const char* kNoLibrary = "the library was not found at build time";

TEST_P(AnyStepper, FallsFreelyAsImplicitEulerDoes) {
  BodyModel model = bar({1e5, 0.3, 1000, 0, 0.01});
  model.gravity = Vec3(1, -9.81, 0.5);
  const auto stepper = make(model);
  if (!stepper) GTEST_SKIP() << kNoLibrary;
  for (int k = 1; k <= 10; ++k) stepper->step(k, kStep);
  const double h = kStep / GetParam().substeps, n = 10 * GetParam().substeps;
  for (std::size_t i = 0; i < model.mesh.nodes.size(); ++i) {
    EXPECT_LT((stepper->positions()[i] - model.mesh.nodes[i] - n * (n + 1) / 2 * h * h * model.gravity).norm(), 1e-10);
    EXPECT_LT((stepper->velocities()[i] - n * h * model.gravity).norm(), 1e-9);
  }
}

TEST_P(AnyStepper, FallsThroughMassDampingAsImplicitEulerDoes) {
  BodyModel model = bar({1e5, 0.3, 1000, 3, 0});
  model.gravity = Vec3(0, -9.81, 0);
  const auto stepper = make(model);
  if (!stepper) GTEST_SKIP() << kNoLibrary;
  for (int k = 1; k <= 10; ++k) stepper->step(k, kStep);
  const double h = kStep / GetParam().substeps;
  double v = 0;
  for (int k = 0; k < 10 * GetParam().substeps; ++k) v = (v - h * 9.81) / (1 + 3 * h);
  for (const Vec3& velocity : stepper->velocities()) EXPECT_LT((velocity - Vec3(0, v, 0)).norm(), 1e-9);
}

TEST_P(AnyStepper, StaysAtRest) {
  BodyModel model = bar({1e5, 0.45, 1000, 0, 0});
  model.pins = {make_pin(root(model))};
  const auto stepper = make(model);
  if (!stepper) GTEST_SKIP() << kNoLibrary;
  for (int k = 1; k <= 10; ++k) stepper->step(k, kStep);
  EXPECT_LT(distance(stepper->positions(), model.mesh.nodes), 1e-12);
}

TEST_P(AnyStepper, HoldsItsPinsExactlyAndComesToRestWhereTheyTurnIt) {
  BodyModel model = bar({1e5, 0.3, 1000, 4, 0.02});
  Transform turned;
  turned.rotate = Vec3(0.3, 0, std::numbers::pi / 2);
  turned.translate = Vec3(0.1, 0, 0);
  Pin pin = make_pin(root(model));
  pin.track = {{{0, {}, Ease::Linear}, {40, turned, Ease::Linear}}};
  model.pins = {pin};
  const auto stepper = make(model);
  if (!stepper) GTEST_SKIP() << kNoLibrary;
  for (int k = 1; k <= 240; ++k) stepper->step(k, kStep);
  std::vector<Vec3> expected;
  for (const Vec3& x : model.mesh.nodes) expected.push_back(turned.apply(x));
  const PinnedNodes pinned = NodePins(model.pins, model.embedding, model.mesh).at(240);
  ASSERT_GT(pinned.count, 0);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (pinned.held[i] == 0) continue;
    EXPECT_EQ(stepper->positions()[i], pinned.targets[i]);
  }
  EXPECT_LT(distance(stepper->positions(), expected), 1e-4);
}

/// Linear and angular momentum, kg m/s and kg m^2/s about the origin.
std::pair<Vec3, Vec3> momenta(const Stepper& stepper, const NodalMasses& masses) {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  for (std::size_t i = 0; i < masses.mass.size(); ++i) {
    const Vec3 p = masses.mass[i] * stepper.velocities()[i];
    linear += p;
    angular += stepper.positions()[i].cross(p);
  }
  return {linear, angular};
}

TEST_P(AnyStepper, KeepsLinearMomentumAndHardlyGainsAngular) {
  BodyModel model = bar({1e5, 0.3, 1000, 0, 0});
  Transform away;
  away.translate = Vec3(0.2, 0.3, -0.1);
  Pull pull = make_pull(end_nodes(model), away, 200);
  pull.active = {{0, 6}};
  model.pulls = {pull};
  const auto stepper = make(model);
  if (!stepper) GTEST_SKIP() << kNoLibrary;
  for (int k = 1; k <= 6; ++k) stepper->step(k, kStep);
  const NodalMasses masses = lump_masses(model.mesh, model.materials);
  const auto [linear, angular] = momenta(*stepper, masses);
  ASSERT_GT(linear.norm(), 1);
  ASSERT_GT(angular.norm(), 0.1);
  for (int k = 7; k <= 30; ++k) stepper->step(k, kStep);
  const auto [linear_after, angular_after] = momenta(*stepper, masses);
  EXPECT_LT((linear_after - linear).norm(), 1e-9 * linear.norm());
  EXPECT_LT(angular_after.norm(), 1.001 * angular.norm());
  EXPECT_GT(angular_after.norm(), 0.5 * angular.norm());
}

TEST_P(AnyStepper, ComesToTheStaticEquilibriumOfSoftreel) {
  const BodyModel model = hanging_bar();
  const auto stepper = make(model);
  if (!stepper) GTEST_SKIP() << kNoLibrary;
  Bench statics(model, euler_params());
  ASSERT_TRUE(statics.simulator.find_equilibrium(1).ok());
  for (int k = 1; k <= 200; ++k) stepper->step(k, kStep);
  const double sag = distance(statics.simulator.state().positions, model.mesh.nodes);
  ASSERT_GT(sag, 1e-2);
  EXPECT_LT(distance(stepper->positions(), statics.simulator.state().positions), GetParam().static_error * sag);
}

TEST_P(AnyStepper, RefusesPinsThatContradictEachOther) {
  BodyModel model = bar({});
  Transform away;
  away.translate = Vec3(0, 1, 0);
  Pin second = make_pin(root(model));
  second.track = {{{0, {}, Ease::Linear}, {2, {}, Ease::Linear}, {3, away, Ease::Linear}, {4, {}, Ease::Linear}}};
  model.pins = {make_pin(root(model)), second};
  EXPECT_ANY_THROW({
    const auto stepper = make(model);
    if (!stepper) throw std::runtime_error("no library");
    for (int k = 1; k <= 3; ++k) stepper->step(k, kStep);
  });
}

INSTANTIATE_TEST_SUITE_P(All, AnyStepper, ::testing::ValuesIn(methods()),
                         [](const auto& method) { return std::string(method.param.name); });

/// A bar that is shaken, pulled and damped, so that every term of a step matters.
BodyModel busy_bar(double damping_stiffness = 0.004) {
  BodyModel model = bar({1e5, 0.4, 1000, 1, damping_stiffness});
  model.gravity = Vec3(0, -9.81, 0);
  Transform moved, away;
  moved.translate = Vec3(0.05, 0.1, 0);
  moved.rotate = Vec3(0.5, 0, 0.4);
  away.translate = Vec3(0, 0.1, 0.2);
  Pin pin = make_pin(root(model));
  pin.track = {{{0, {}, Ease::Smooth}, {8, moved, Ease::Smooth}}};
  model.pins = {pin};
  model.pulls = {make_pull(end_nodes(model), away, 300)};
  return model;
}

class Direct : public ::testing::TestWithParam<DirectSolver> {};

TEST_P(Direct, TakesTheStepsOfSoftreel) {
  const BodyModel model = busy_bar();
  const Threads threads(1);
  const auto ours = make_softreel(model, euler_params(), threads);
  const auto theirs = make_direct(model, euler_params(), GetParam());
  if (!theirs) GTEST_SKIP() << kNoLibrary;
  for (int k = 1; k <= 12; ++k) {
    ours->step(k, kStep);
    theirs->step(k, kStep);
    EXPECT_LT(distance(ours->positions(), theirs->positions()), 1e-9) << "step " << k;
    EXPECT_LT(distance(ours->velocities(), theirs->velocities()), 1e-7) << "step " << k;
  }
  ASSERT_GT(distance(ours->positions(), model.mesh.nodes), 0.1);
}

/// Its system does not fit what it was made for: the nodes that are held change.
TEST_P(Direct, FollowsPinsThatLetGo) {
  BodyModel model = busy_bar();
  model.pins[0].active = {{0, 3}, {6, 8}};
  const Threads threads(1);
  const auto ours = make_softreel(model, euler_params(), threads);
  const auto theirs = make_direct(model, euler_params(), GetParam());
  if (!theirs) GTEST_SKIP() << kNoLibrary;
  for (int k = 1; k <= 8; ++k) {
    ours->step(k, kStep);
    theirs->step(k, kStep);
    EXPECT_LT(distance(ours->positions(), theirs->positions()), 1e-9) << "step " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, Direct,
                         ::testing::Values(DirectSolver::EigenLdlt, DirectSolver::Cholmod,
                                           DirectSolver::EigenCgIncompleteCholesky, DirectSolver::EigenCgDiagonal));

class DirectGradients : public ::testing::TestWithParam<DirectSolver> {};

TEST_P(DirectGradients, TakeFewerIterationsFromTheLastStepsAccelerations) {
  const BodyModel model = busy_bar();
  SolverParams params = euler_params();
  params.tolerance = 1e-6;
  const auto guessed = make_direct(model, params, GetParam()),
             plain = make_direct(model, params, GetParam(), FirstGuess::None);
  const int steps = 48;
  for (int k = 1; k <= steps; ++k) {
    guessed->step(k / 4.0, kStep / 4);
    plain->step(k / 4.0, kStep / 4);
  }
  EXPECT_LT(guessed->iterations(), plain->iterations());
  EXPECT_GT(guessed->iterations(), 0);
  EXPECT_LT(distance(guessed->positions(), plain->positions()), 1e-4 * distance(plain->positions(), model.mesh.nodes));
}

INSTANTIATE_TEST_SUITE_P(Solvers, DirectGradients,
                         ::testing::Values(DirectSolver::EigenCgIncompleteCholesky, DirectSolver::EigenCgDiagonal));

TEST(DirectStepper, FactorizationsDoNotIterate) {
  const auto stepper = make_direct(busy_bar(), euler_params(), DirectSolver::EigenLdlt);
  stepper->step(1, kStep);
  EXPECT_EQ(stepper->iterations(), 0);
}

TEST(DescentMemory, MapsTheLastChangeOfGradientToTheLastMove) {
  const auto random = [] { return Eigen::MatrixX3d::Random(7, 3).eval(); };
  const auto precondition = [](const Eigen::MatrixX3d& v) { return (0.5 * v).eval(); };
  DescentMemory memory(2);
  const Eigen::MatrixX3d gradient = random();
  EXPECT_LT((memory.direction(gradient, precondition) - 0.5 * gradient).norm(), 1e-14);
  for (int k = 0; k < 4; ++k) {
    const Eigen::MatrixX3d move = random(), change = 2 * move + 0.3 * random();
    ASSERT_GT(move.cwiseProduct(change).sum(), 0);
    memory.remember(move, change);
    EXPECT_LT((memory.direction(change, precondition) - move).norm(), 1e-12);
    memory.remember(move, -change);  // curves downwards: not taken
    EXPECT_LT((memory.direction(change, precondition) - move).norm(), 1e-12);
  }
  memory.forget();
  EXPECT_LT((memory.direction(gradient, precondition) - 0.5 * gradient).norm(), 1e-14);
}

TEST(Projective, ConvergesToTheIteratedStepOfSoftreel) {
  const BodyModel model = busy_bar();
  SolverParams params = euler_params();
  params.linearize = Linearize::Iterated;
  const Threads threads(1);
  const auto ours = make_softreel(model, params, threads);
  const auto few = make_projective_dynamics(model, {20}), many = make_projective_dynamics(model, {1000});
  const auto remembering = make_projective_dynamics(model, {100, 5});
  double few_error = 0, many_error = 0, remembering_error = 0;
  for (int k = 1; k <= 8; ++k) {
    for (Stepper* stepper : {ours.get(), few.get(), many.get(), remembering.get()}) stepper->step(k, kStep);
    few_error = std::max(few_error, distance(few->positions(), ours->positions()));
    many_error = std::max(many_error, distance(many->positions(), ours->positions()));
    remembering_error = std::max(remembering_error, distance(remembering->positions(), ours->positions()));
  }
  EXPECT_LT(many_error, 1e-7);
  EXPECT_LT(remembering_error, 1e-6);
  EXPECT_LT(many_error, 1e-2 * few_error);
}

TEST(Xpbd, ItsStaticErrorIsOfSecondOrderInTheSubstep) {
  const BodyModel model = hanging_bar();
  Bench statics(model, euler_params());
  ASSERT_TRUE(statics.simulator.find_equilibrium(1).ok());
  std::vector<double> errors;
  for (const int substeps : {5, 10, 20}) {
    const auto stepper = make_xpbd(model, {substeps, 1});
    for (int k = 1; k <= 200; ++k) stepper->step(k, kStep);
    errors.push_back(distance(stepper->positions(), statics.simulator.state().positions));
  }
  EXPECT_GT(errors[0] / errors[1], 3);
  EXPECT_GT(errors[1] / errors[2], 3);
}

/// Without damping by stiffness, which XPBD has along its constraints only.
TEST(Xpbd, ConvergesToTheMotionOfSoftreelWithItsSteps) {
  const BodyModel model = busy_bar(0);
  SolverParams params = euler_params();
  params.linearize = Linearize::Iterated;
  params.integrator = Integrator::Bdf2;
  const Threads threads(1);
  const auto ours = make_softreel(model, params, threads);
  for (int k = 1; k <= 4 * 96; ++k) ours->step(k / 96.0, kStep / 96);
  std::vector<double> errors;
  for (const int steps : {50, 100, 200}) {
    const auto stepper = make_xpbd(model, {1, 1});
    for (int k = 1; k <= 4 * steps; ++k) stepper->step(k / static_cast<double>(steps), kStep / steps);
    errors.push_back(distance(stepper->positions(), ours->positions()));
  }
  EXPECT_LT(errors[1], 0.6 * errors[0]);
  EXPECT_LT(errors[2], 0.6 * errors[1]);
}

TEST(Steppers, RefuseWhatTheyAreNotBuiltFor) {
  BodyModel model = busy_bar();
  model.pulls[0].max_force = 1;
  EXPECT_THROW(make_xpbd(model, {})->step(1, kStep), std::runtime_error);
  EXPECT_THROW(make_projective_dynamics(model, {})->step(1, kStep), std::runtime_error);
  EXPECT_THROW(make_xpbd(model, {0, 1}), std::runtime_error);
  EXPECT_THROW(make_projective_dynamics(model, {0}), std::runtime_error);
  SolverParams params = euler_params();
  params.integrator = Integrator::Bdf2;
  EXPECT_THROW(make_direct(model, params, DirectSolver::EigenLdlt), std::runtime_error);
}

}  // namespace
}  // namespace softreel::bench
