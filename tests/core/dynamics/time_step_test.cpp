// The time integrators: order, energy, frequencies, memory.
#include "core/dynamics/time_step.h"

#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/dynamics/simulator.h"
#include "core/elasticity/mass.h"
#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;
using testing::exact_params;

struct Scheme {
  const char* name;
  Integrator integrator;
  Linearize linearize;
  double order;
};

SolverParams params_of(const Scheme& scheme) {
  SolverParams params = exact_params();
  params.integrator = scheme.integrator;
  params.linearize = scheme.linearize;
  params.recovery = false;  // the bar inverts for some steps: rotations that are shared now and then have no order
  return params;
}

TetMesh thin_bar() {
  return testing::kuhn_bar({4, 1, 1}, Vec3(0.8, 0.2, 0.2));
}

/// Soft and damped, so that its modes are slow against the steps of these tests.
ElementMaterial slow(double damping_stiffness) {
  return {2e4, 0.3, 1000, 0.2, damping_stiffness};
}

/// A bar that one end turns and carries along by keys, hung with a spring at the other end, under its weight: pins,
/// pulls, damping and a turn by 140 degrees.
BodyModel turned_bar() {
  BodyModel model = body_model(thin_bar(), slow(0.01));
  const auto ends = [&](bool low) {
    return testing::select_nodes(model.mesh, [low](const Vec3& p) { return low ? p.x() < 1e-9 : p.x() > 0.79; });
  };
  Transform half, full;
  half.rotate = Vec3(0, 0, 1.2);
  full.rotate = Vec3(0, 0, 2.4);
  full.translate = Vec3(0, 0.3, 0.1);
  half.translate = 0.5 * full.translate;
  Pin pin = testing::make_pin(ends(true));
  // Smooth keys: at rest at frame 0 and 2, no jump of velocity within.
  pin.track = {{{0, {}, Ease::Smooth}, {2, full, Ease::Smooth}}};
  model.pins = {pin};
  model.pulls = {testing::make_pull(ends(false), half, 20)};
  return model;
}

/// Positions after `seconds` in `steps` equal steps; frame 1 is their end.
std::vector<Vec3> positions_after(const BodyModel& model, const SolverParams& params, double seconds, int steps) {
  Bench bench(model, params);
  for (int k = 1; k <= steps; ++k) {
    const StepReport report = bench.simulator.step(static_cast<double>(k) / steps, seconds / steps);
    EXPECT_TRUE(report.ok()) << report.culprit;
  }
  return bench.simulator.state().positions;
}

double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// By steps of `seconds` / steps, half and a quarter of them.
double measured_order(const BodyModel& model, const SolverParams& params, double seconds, int steps) {
  const std::vector<Vec3> coarse = positions_after(model, params, seconds, steps),
                          middle = positions_after(model, params, seconds, 2 * steps),
                          fine = positions_after(model, params, seconds, 4 * steps);
  return std::log2(distance(coarse, middle) / distance(middle, fine));
}

TEST(TimeStep, HasTheOrderOfItsIntegratorUnlessItIsLinearisedAtTheStart) {
  const Scheme schemes[] = {{"euler, start", Integrator::Euler, Linearize::Start, 1},
                            {"euler, predictor", Integrator::Euler, Linearize::Predictor, 1},
                            {"euler, iterated", Integrator::Euler, Linearize::Iterated, 1},
                            {"bdf2, start", Integrator::Bdf2, Linearize::Start, 1},
                            {"bdf2, predictor", Integrator::Bdf2, Linearize::Predictor, 2},
                            {"bdf2, iterated", Integrator::Bdf2, Linearize::Iterated, 2},
                            {"newmark, start", Integrator::Newmark, Linearize::Start, 1},
                            {"newmark, predictor", Integrator::Newmark, Linearize::Predictor, 2},
                            {"newmark, iterated", Integrator::Newmark, Linearize::Iterated, 2}};
  const BodyModel model = turned_bar();
  for (const Scheme& scheme : schemes) {
    const double order = measured_order(model, params_of(scheme), 1.0, 256);
    RecordProperty(scheme.name, fmt::format("{:.3f}", order));
    EXPECT_NEAR(order, scheme.order, 0.15) << scheme.name;
  }
}

/// At rest, but longer by `strain`.
SimulationState stretched(const Simulator& simulator, double strain) {
  SimulationState state = simulator.state();
  for (Vec3& position : state.positions) position.x() *= 1 + strain;
  return state;
}

BodyModel free_bar() {
  BodyModel model = body_model(thin_bar(), {2e4, 0.3, 1000, 0, 0});
  model.gravity.setZero();
  return model;
}

double total_energy(const Simulator& simulator) {
  const StateMeasures measures = simulator.measure();
  return measures.kinetic_energy + measures.elastic_energy + measures.potential_energy;
}

/// Greatest relative change of energy over the steps.
double energy_drift(Bench& bench, int steps, double seconds) {
  const double start = total_energy(bench.simulator);
  double drift = 0;
  for (int k = 1; k <= steps; ++k) {
    EXPECT_TRUE(bench.simulator.step(k, seconds).ok());
    drift = std::max(drift, std::abs(total_energy(bench.simulator) / start - 1));
  }
  return drift;
}

TEST(TimeStep, NewmarkKeepsTheEnergyOfSmallStrainOverTenThousandSteps) {
  SolverParams params = params_of({"", Integrator::Newmark, Linearize::Predictor, 2});
  params.rotation = RotationMethod::None;
  params.tolerance = 1e-14;
  BodyModel model = body_model(testing::kuhn_bar({2, 1, 1}, Vec3(0.4, 0.2, 0.2)), {2e4, 0.3, 1000, 0, 0});
  model.gravity.setZero();
  Bench bench(model, params);
  bench.simulator.set_state(stretched(bench.simulator, 0.01));
  const double drift = energy_drift(bench, 10000, 0.01);
  RecordProperty("drift", fmt::format("{:.3g}", drift));
  EXPECT_LT(drift, 1e-9);
}

TEST(TimeStep, NewmarkBoundsTheDriftOfEnergyWhereElementsTurn) {
  Bench bench(free_bar(), params_of({"", Integrator::Newmark, Linearize::Predictor, 2}));
  SimulationState state = stretched(bench.simulator, 0.1);
  for (std::size_t i = 0; i < state.positions.size(); ++i)
    state.velocities[i] = Vec3(0, 1, 3).cross(state.positions[i] - Vec3(0.4, 0.1, 0.1));
  bench.simulator.set_state(state);
  const double drift = energy_drift(bench, 1000, 0.005);
  RecordProperty("drift", fmt::format("{:.3g}", drift));
  EXPECT_LT(drift, 0.01) << "over 16 turns";
}

TEST(TimeStep, EulerAndBdf2LoseEnergy) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    SolverParams params = params_of({"", integrator, Linearize::Auto, 0});
    params.rotation = RotationMethod::None;
    Bench bench(free_bar(), params);
    bench.simulator.set_state(stretched(bench.simulator, 0.01));
    double last = total_energy(bench.simulator);
    for (int k = 1; k <= 20; ++k) {
      ASSERT_TRUE(bench.simulator.step(k, 0.01).ok());
      const double now = total_energy(bench.simulator);
      EXPECT_LT(now, 1.01 * last);
      last = now;
    }
  }
}

/// Frequencies in rad/s and shapes of the lumped body from the dense generalised eigenvalue problem, lowest first.
struct Modes {
  Eigen::VectorXd frequencies;
  Eigen::MatrixXd shapes;
  Eigen::VectorXd masses;  ///< per scalar unknown
};

Modes find_modes(const BodyModel& model) {
  const ElementMaterial& material = model.materials[0];
  const test_support::ElasticParams params{material.youngs_modulus, material.poisson_ratio, material.density, 0};
  const Eigen::MatrixXd K = test_support::dense(test_support::assemble(model.mesh, params, {}).matrix);
  Modes modes;
  modes.masses.resize(K.rows());
  const NodalMasses masses = lump_masses(model.mesh, model.materials);
  for (Eigen::Index i = 0; i < K.rows(); ++i) modes.masses[i] = masses.mass[static_cast<std::size_t>(i / 3)];
  const Eigen::MatrixXd M = modes.masses.asDiagonal();
  const test_support::EigenPairs pairs = test_support::generalized_eigenpairs(K, M);
  modes.frequencies = pairs.values.cwiseMax(0).cwiseSqrt();
  modes.shapes = pairs.vectors;
  return modes;
}

/// Share of a mode in the displacements.
double amplitude(const Modes& modes, Eigen::Index mode, const Simulator& simulator) {
  double sum = 0;
  for (std::size_t i = 0; i < simulator.state().positions.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    const Vec3 displacement = simulator.state().positions[i] - simulator.model().mesh.nodes[i];
    sum += modes.masses[at] * displacement.dot(modes.shapes.col(mode).segment<3>(at));
  }
  return sum;
}

/// The mode's frequency from the time series: q(t + h) + q(t - h) = 2 cos(angle) q(t), and the trapezoidal rule turns
/// by tan(angle / 2) = frequency h / 2 a step.
TEST(TimeStep, NewmarkSwingsAtTheFrequenciesOfTheGeneralisedEigenvalueProblem) {
  const BodyModel model = free_bar();
  const Modes modes = find_modes(model);
  ASSERT_LT(modes.frequencies[5], 1e-3 * modes.frequencies[6]) << "six rigid motions";
  for (Eigen::Index mode = 6; mode < 12; ++mode) {
    Bench bench(model, params_of({"", Integrator::Newmark, Linearize::Predictor, 2}));
    SimulationState state = bench.simulator.state();
    for (std::size_t i = 0; i < state.positions.size(); ++i)
      state.positions[i] += 1e-6 * modes.shapes.col(mode).segment<3>(static_cast<Eigen::Index>(3 * i));
    bench.simulator.set_state(state);
    const double h = 0.3 / modes.frequencies[mode];
    double q[5];
    for (int k = 0; k < 5; ++k) {
      q[k] = amplitude(modes, mode, bench.simulator);
      ASSERT_TRUE(bench.simulator.step(k + 1, h).ok());
    }
    for (int k = 1; k < 4; ++k) {
      const double angle = std::acos((q[k + 1] + q[k - 1]) / (2 * q[k]));
      EXPECT_NEAR(2 / h * std::tan(0.5 * angle) / modes.frequencies[mode], 1, 1e-4) << "mode " << mode;
    }
  }
}

void expect_same_bits(const SimulationState& a, const SimulationState& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.velocities, b.velocities);
  EXPECT_EQ(a.previous_positions, b.previous_positions);
  EXPECT_EQ(a.previous_velocities, b.previous_velocities);
  EXPECT_EQ(a.accelerations, b.accelerations);
  EXPECT_EQ(a.previous_accelerations, b.previous_accelerations);
  EXPECT_EQ(a.previous_seconds, b.previous_seconds);
  for (std::size_t e = 0; e < a.rotations.size(); ++e) EXPECT_EQ(a.rotations[e].coeffs(), b.rotations[e].coeffs());
}

TEST(TimeStep, ContinuesAStoredFrameWithTheSameBits) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark})
    for (const double tolerance : {1e-3, 1e-10}) {  // in float and in double
      SolverParams params;
      params.integrator = integrator;
      params.tolerance = tolerance;
      Bench whole(turned_bar(), params), resumed(turned_bar(), params);
      for (int step = 1; step <= 24; ++step) {
        if (step == 13) resumed.simulator.set_state(whole.simulator.state());
        const double frame = step / 4.0;
        ASSERT_TRUE(whole.simulator.step(frame, 1.0 / 96).ok());
        if (step <= 12) continue;
        ASSERT_TRUE(resumed.simulator.step(frame, 1.0 / 96).ok());
      }
      expect_same_bits(whole.simulator.state(), resumed.simulator.state());
    }
}

TEST(TimeStep, RemembersOnlyWhatIntegratorAndSolverNeed) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2, Integrator::Newmark}) {
    SolverParams params;
    params.integrator = integrator;
    Bench bench(turned_bar(), params);
    ASSERT_TRUE(bench.simulator.step(0.5, 1.0 / 48).ok());
    const SimulationState& state = bench.simulator.state();
    EXPECT_EQ(state.previous_positions.empty(), integrator == Integrator::Euler);  // Newmark: to damp strain
    EXPECT_EQ(state.previous_velocities.empty(), integrator != Integrator::Bdf2);
    EXPECT_FALSE(state.accelerations.empty());
    EXPECT_EQ(state.previous_accelerations.empty(), integrator != Integrator::Newmark);  // it starts from its own
    EXPECT_EQ(state.previous_seconds, integrator == Integrator::Euler ? 0 : 1.0 / 48);
  }
}

TEST(TimeStep, GuessesSaveIterationsAndNoAccuracy) {
  // Newmark lets every mode ring, so that there is less to foresee.
  for (const auto& [integrator, share] :
       {std::pair(Integrator::Euler, 0.65), std::pair(Integrator::Bdf2, 0.8), std::pair(Integrator::Newmark, 0.95)}) {
    SolverParams params;
    params.integrator = integrator;
    SolverParams exact = exact_params();
    exact.integrator = integrator;
    // One solve a step: iterated steps end at the same place whatever they begin with.
    params.linearize = exact.linearize = integrator == Integrator::Euler ? Linearize::Start : Linearize::Predictor;
    const BodyModel model = testing::body_model(test_support::make_bar(4), {1e5, 0.4, 1000, 0.1, 0.002});
    const std::vector<Index> end = testing::select_nodes(model.mesh, [](const Vec3& x) { return x[0] < 1e-9; });
    BodyModel held = model;
    held.pins = {testing::make_pin(end)};
    Bench guessed(held, params), plain(held, params), truth(held, exact);
    int with = 0, without = 0;
    double guess_error = 0, plain_error = 0;
    for (int k = 1; k <= 96; ++k) {
      SimulationState forgetful = plain.simulator.state();
      if (integrator != Integrator::Newmark) forgetful.accelerations.clear();
      forgetful.previous_accelerations.clear();
      plain.simulator.set_state(forgetful);
      with += guessed.simulator.step(k / 4.0, 1.0 / 96).solve.iterations;
      without += plain.simulator.step(k / 4.0, 1.0 / 96).solve.iterations;
      ASSERT_TRUE(truth.simulator.step(k / 4.0, 1.0 / 96).ok());
      const std::vector<Vec3>& right = truth.simulator.state().positions;
      // Root mean squares over the steps: the worst single step is a matter of chance.
      guess_error = std::hypot(guess_error, distance(guessed.simulator.state().positions, right));
      plain_error = std::hypot(plain_error, distance(plain.simulator.state().positions, right));
    }
    RecordProperty(fmt::format("{}", static_cast<int>(integrator)),
                   fmt::format("{} {} {:.3g} {:.3g}", with, without, guess_error, plain_error));
    EXPECT_LT(with, share * without);
    EXPECT_LT(guess_error, 1.5 * plain_error) << static_cast<int>(integrator);
  }
}

TEST(TimeStep, SolvesTheSameStepsInFloatAndInDouble) {
  const Scheme schemes[] = {{"euler, predictor", Integrator::Euler, Linearize::Predictor, 1},
                            {"bdf2, start", Integrator::Bdf2, Linearize::Start, 1},
                            {"bdf2, predictor", Integrator::Bdf2, Linearize::Predictor, 2},
                            {"newmark, predictor", Integrator::Newmark, Linearize::Predictor, 2}};
  for (const Scheme& scheme : schemes) {
    SolverParams in_float = params_of(scheme);
    in_float.tolerance = 1e-6;
    const BodyModel model = turned_bar();
    const std::vector<Vec3> expected = positions_after(model, params_of(scheme), 1.0, 48);
    EXPECT_LT(distance(positions_after(model, in_float, 1.0, 48), expected), 1e-5) << scheme.name;
  }
}

TEST(TimeStep, FallsExactlyByIntegratorsOfSecondOrder) {
  const double h = 1.0 / 48, time = 20 * h, exact = 9.81 * time * time / 2;
  for (const Integrator integrator : {Integrator::Bdf2, Integrator::Newmark}) {
    SolverParams params;
    params.integrator = integrator;
    Bench bench(body_model(thin_bar(), {2e4, 0.3, 1000, 0, 0}), params);
    const std::vector<Vec3> start = bench.simulator.state().positions;
    for (int k = 1; k <= 20; ++k) ASSERT_TRUE(bench.simulator.step(k, h).ok());
    for (std::size_t i = 0; i < start.size(); ++i)
      EXPECT_NEAR(start[i].y() - bench.simulator.state().positions[i].y(), exact, 1e-8 * exact);
  }
}

/// The bar of the performance targets under its weight for a second from rest: how far any node gets from the origin.
double farthest_swing(Linearize linearize, int steps) {
  BodyModel model = body_model(test_support::make_bar(3), {1e6, 0.4, 1000, 0.1, 0.002});
  model.pins = {testing::make_pin(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; }))};
  SolverParams params;
  params.integrator = Integrator::Newmark;
  params.linearize = linearize;
  params.tolerance = 1e-6;
  Bench bench(std::move(model), params);
  double farthest = 0;
  for (int s = 1; s <= steps; ++s) {
    if (!bench.simulator.step(24.0 * s / steps, 1.0 / steps).ok()) return INFINITY;
    for (const Vec3& x : bench.simulator.state().positions) farthest = std::max(farthest, x.norm());
  }
  return farthest;
}

TEST(Newmark, OneSolveAStepSwingsNoFartherThanIteratedSteps) {
  const double iterated = farthest_swing(Linearize::Iterated, 96);
  for (const int steps : {24, 48, 96}) {
    EXPECT_NEAR(farthest_swing(Linearize::Predictor, steps), iterated, 0.02) << steps << " steps a second";
    EXPECT_NEAR(farthest_swing(Linearize::Start, steps), iterated, 0.02) << steps << " steps a second";
  }
}

TEST(Linearization, OfAnIntegratorIsTheCheapestThatIsSafeWithIt) {
  const auto automatic = [](Integrator integrator) {
    SolverParams params;
    params.integrator = integrator;
    return linearization(params);
  };
  EXPECT_EQ(automatic(Integrator::Euler), Linearize::Start);
  EXPECT_EQ(automatic(Integrator::Bdf2), Linearize::Predictor);
  EXPECT_EQ(automatic(Integrator::Newmark), Linearize::Iterated);
}

}  // namespace
}  // namespace softreel
