/// Pins and pulls that take a body where it is.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/constraints/pulls.h"
#include "core/dynamics/frame_steps.h"
#include "core/dynamics/simulator.h"
#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::kFps;

constexpr int kStart = 1, kGrabbed = 5, kReleased = 9, kAgain = 12, kEnd = 16;

/// A bar held at its left end; at the right end, what a test asks for while active in two ranges.
BodyModel swinging_bar() {
  ElementMaterial soft;
  soft.youngs_modulus = 2e4;
  soft.poisson_ratio = 0.3;
  BodyModel model = testing::body_model(testing::kuhn_bar({6, 2, 2}, Vec3(0.6, 0.2, 0.2)), soft);
  model.pins.push_back(
      testing::make_pin(testing::select_nodes(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; })));
  return model;
}

std::vector<Index> tip(const TetMesh& mesh) {
  return testing::select_nodes(mesh, [](const Vec3& p) { return p.x() > 0.6 - 1e-9; });
}

Track<Transform> lifted_from(int frame) {
  Transform up;
  up.translate = Vec3(0, 0.1, 0.02);
  return {{{double(frame), {}, Ease::Linear}, {double(frame) + 4, up, Ease::Linear}}};
}

BodyModel with_pin(bool grab) {
  BodyModel model = swinging_bar();
  Pin pin = testing::make_pin(tip(model.mesh));
  pin.name = "body.bar.pin[1]";
  pin.track = lifted_from(kGrabbed);
  pin.active = {{kGrabbed, kReleased}, {kAgain, kEnd}};
  pin.grab = grab;
  model.pins.push_back(pin);
  return model;
}

BodyModel with_pull(bool grab) {
  BodyModel model = swinging_bar();
  Pull pull = testing::make_pull(tip(model.mesh), {}, 0);
  pull.track = lifted_from(kGrabbed);
  pull.stiffness = {{{1, 0, Ease::Constant},
                     {kGrabbed, 400, Ease::Constant},
                     {kReleased + 1, 0, Ease::Constant},
                     {kAgain, 400, Ease::Constant}}};
  pull.grab = grab;
  model.pulls.push_back(pull);
  return model;
}

void advance(Simulator& simulator, int frame) {
  ASSERT_TRUE(advance_to_frame(
                  simulator, frame, kFps, [] {}, [](int) {})
                  .ok())
      << "frame " << frame;
}

double farthest_move(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const std::vector<Index>& points) {
  double farthest = 0;
  for (const Index i : points)
    farthest = std::max(farthest, (a[static_cast<std::size_t>(i)] - b[static_cast<std::size_t>(i)]).norm());
  return farthest;
}

TEST(Grab, OfAPinHoldsWhereThePointsAreAndMovesThemAsTheKeysDo) {
  BodyModel model = with_pin(true);
  model.pins[1].active = {{kGrabbed, kEnd}};
  const std::vector<Index> points = tip(model.mesh);
  Bench bench(model);
  bench.simulator.start_grabs(kStart);
  for (int frame = kStart + 1; frame <= kGrabbed; ++frame) advance(bench.simulator, frame);
  const std::vector<Vec3> taken = bench.simulator.state().positions;
  EXPECT_GT(farthest_move(taken, model.mesh.nodes, points), 0.005) << "it has sagged by then";
  for (int frame = kGrabbed + 1; frame <= kEnd; ++frame) {
    advance(bench.simulator, frame);
    const Vec3 lift = model.pins[1].track.at(frame).translate;
    for (const Index i : points) {
      const Vec3 expected = taken[static_cast<std::size_t>(i)] + lift;
      EXPECT_LT((bench.simulator.state().positions[static_cast<std::size_t>(i)] - expected).norm(), 1e-15);
    }
  }
}

TEST(Grab, StartsWithoutAJumpEachTimeWhereAPlainPinJumps) {
  double jump[2]{};
  for (const bool grab : {false, true}) {
    BodyModel model = with_pin(grab);
    model.pins[1].track = testing::constant(Transform{});
    const std::vector<Index> points = tip(model.mesh);
    Bench bench(model);
    bench.simulator.start_grabs(kStart);
    for (int frame = kStart + 1; frame <= kAgain + 1; ++frame) {
      const std::vector<Vec3> before = bench.simulator.state().positions;
      advance(bench.simulator, frame);
      const double move = farthest_move(bench.simulator.state().positions, before, points);
      const bool is_start = grab ? frame == kGrabbed + 1 || frame == kAgain + 1 : frame == kGrabbed || frame == kAgain;
      if (is_start) jump[grab ? 1 : 0] = std::max(jump[grab ? 1 : 0], move);
    }
  }
  EXPECT_EQ(jump[1], 0) << "keys that rest hold the points to the last bit";
  EXPECT_GT(jump[0], 0.005);
}

TEST(Grab, HoldsOnFromOneRangeIntoTheNext) {
  BodyModel model = with_pin(true);
  model.pins[1].track = testing::constant(Transform{});
  model.pins[1].active = {{kGrabbed, kReleased}, {kReleased + 1, kEnd}};
  const std::vector<Index> points = tip(model.mesh);
  Bench bench(model);
  bench.simulator.start_grabs(kStart);
  for (int frame = kStart + 1; frame <= kGrabbed; ++frame) advance(bench.simulator, frame);
  const std::vector<Vec3> taken = bench.simulator.state().positions;
  for (int frame = kGrabbed + 1; frame <= kEnd; ++frame) {
    advance(bench.simulator, frame);
    EXPECT_EQ(farthest_move(bench.simulator.state().positions, taken, points), 0) << frame;
  }
}

TEST(Grab, OfAFallingBodyPullsNoHarderThanMaxForce) {
  BodyModel model = swinging_bar();
  model.pins.clear();
  Pull pull = testing::make_pull(tip(model.mesh), {}, 1e6);
  pull.max_force = 10;  // N; the bar weighs 235 N
  pull.grab = true;
  pull.active = {{kGrabbed, kEnd}};
  model.pulls = {pull};
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    SolverParams params = testing::exact_params();
    params.integrator = integrator;
    Bench bench(model, params);
    bench.simulator.start_grabs(kStart);
    double before = 0;
    const double weight = 9.81 * 24;
    for (int frame = kStart + 1; frame <= kEnd; ++frame) {
      advance(bench.simulator, frame);
      const double now = bench.simulator.measure().linear_momentum.y();
      const double force = (now - before) * kFps + weight;
      before = now;
      // The change of BDF2's momentum in a step is a third of that of the step before, and two thirds of the forces'.
      EXPECT_LT(force, 10 * 1.02) << frame;
      if (frame > kGrabbed + 5) {
        EXPECT_GT(force, 10 * 0.98) << frame;
      }
    }
  }
}

/// Elastic, kinetic and gravitational energy, J.
double energy(const Simulator& simulator) {
  const StateMeasures measures = simulator.measure();
  return measures.elastic_energy + measures.kinetic_energy + measures.potential_energy;
}

TEST(Grab, OfAPinOrPullAddsNoEnergyWhenItStarts) {
  for (const bool is_pin : {true, false}) {
    BodyModel model = is_pin ? with_pin(true) : with_pull(true);
    (is_pin ? model.pins[1].track : model.pulls[0].track) = testing::constant(Transform{});
    Bench bench(model, testing::exact_params());
    bench.simulator.start_grabs(kStart);
    for (int frame = kStart + 1; frame <= kEnd; ++frame) {
      const double before = energy(bench.simulator);
      advance(bench.simulator, frame);
      // What the springs of a pull give back was the body's before they took it.
      if (!is_pin && frame > kGrabbed + 1) break;
      EXPECT_LE(energy(bench.simulator), before + 1e-9) << frame;
    }
  }
}

TEST(Grab, OfAPullBeginsWithoutForceAndAgainWithEachStrength) {
  BodyModel model = with_pull(true);
  model.pulls[0].track = testing::constant(Transform{});
  Bench bench(model);
  bench.simulator.start_grabs(kStart);
  for (int frame = kStart + 1; frame <= kAgain; ++frame) {
    advance(bench.simulator, frame);
    const Grab& grab = bench.simulator.state().grabs.pulls.at(0);
    const bool is_on = (frame >= kGrabbed && frame <= kReleased) || frame >= kAgain;
    EXPECT_EQ(grab.holds(), is_on) << frame;
    if (frame != kGrabbed && frame != kAgain) continue;
    const std::vector<Index> points = tip(model.mesh);
    for (std::size_t k = 0; k < points.size(); ++k)
      EXPECT_LT((grab.positions[k] - bench.simulator.state().positions[static_cast<std::size_t>(points[k])]).norm(),
                1e-15);
  }
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

TEST(Grab, GoesOnFromAStoredStateWithTheSameBits) {
  for (const BodyModel& model : {with_pin(true), with_pull(true)}) {
    Bench whole(model);
    whole.simulator.start_grabs(kStart);
    SimulationState stored;
    for (int frame = kStart + 1; frame <= kEnd; ++frame) {
      advance(whole.simulator, frame);
      if (frame == kGrabbed + 2) stored = whole.simulator.state();
    }
    Bench resumed(model);
    resumed.simulator.set_state(stored);
    for (int frame = kGrabbed + 3; frame <= kEnd; ++frame) advance(resumed.simulator, frame);
    EXPECT_TRUE(same_bits(resumed.simulator.state().positions, whole.simulator.state().positions));
    EXPECT_TRUE(same_bits(resumed.simulator.state().velocities, whole.simulator.state().velocities));
  }
}

TEST(Grab, InStaticsTakesTheShapeOfTheFrameBefore) {
  BodyModel model = with_pin(true);
  model.pins[1].track = testing::constant(Transform{});
  Bench bench(model, testing::exact_params());
  const std::vector<Index> points = tip(model.mesh);
  std::vector<Vec3> before;
  for (int frame = kStart; frame <= kGrabbed; ++frame) {
    before = bench.simulator.state().positions;
    ASSERT_TRUE(bench.simulator.find_equilibrium(frame).ok());
  }
  EXPECT_GT(farthest_move(before, model.mesh.nodes, points), 0.01);
  EXPECT_EQ(farthest_move(bench.simulator.state().positions, before, points), 0);
}

TEST(Grab, IsOfTheFirstFrameWhereItIsAlwaysOn) {
  BodyModel model = swinging_bar();
  Pull pull = testing::make_pull(tip(model.mesh), {}, 1e6);
  pull.grab = true;
  model.pulls.push_back(pull);
  Bench bench(model);
  bench.simulator.start_grabs(kStart);
  advance(bench.simulator, kStart + 1);
  EXPECT_LT(farthest_move(bench.simulator.state().positions, model.mesh.nodes, tip(model.mesh)), 1e-4);
}

TEST(Pulls, ForcesScaleWithTheWeightsOfTheirPoints) {
  BodyModel model = swinging_bar();
  Transform away;
  away.translate = Vec3(0, 0, 0.3);
  Pull pull = testing::make_pull(tip(model.mesh), away, 100);
  const auto forces = [&] {
    std::vector<Vec3> sum(model.mesh.nodes.size(), Vec3::Zero());
    for (const ActivePull& active : active_pulls({pull}, model.surface_points, model.embedding, model.mesh, 1))
      add_pull_forces(active, model.mesh.nodes, sum);
    return sum;
  };
  const std::vector<Vec3> whole = forces();
  const std::vector<double> painted{0, 0.25, 0.5, 1};
  for (std::size_t k = 0; k < pull.points.size(); ++k) pull.weights[k] *= painted[k % painted.size()];
  const std::vector<Vec3> scaled = forces();
  for (std::size_t k = 0; k < pull.points.size(); ++k) {
    const auto i = static_cast<std::size_t>(pull.points[k]);
    EXPECT_LT((scaled[i] - painted[k % painted.size()] * whole[i]).norm(), 1e-14 * (1 + whole[i].norm()));
  }
}

}  // namespace
}  // namespace softreel
