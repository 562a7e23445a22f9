// What a step leaves as it was: the matrix where hardly anything turned, and the coarse levels.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/dynamics/frame_steps.h"
#include "tests/core/dynamics/dynamics_support.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::body_model;
using testing::greatest_distance;
using testing::kFps;

constexpr int kFrames = 12;

/// A long bar, clamped in the middle and in balance with its weight, of which one end is pulled aside.
BodyModel half_moved_bar() {
  BodyModel model = body_model(test_support::make_box({4, 4, 48}, 0.03), {3e5, 0.35, 1000, 0.5, 0.005});
  const auto between = [&](double low, double high) {
    return testing::select_nodes(model.mesh, [=](const Vec3& p) { return p.z() > low && p.z() < high; });
  };
  model.pins = {testing::make_pin(between(0.65, 0.79))};
  Transform aside;
  aside.translate = Vec3(0.1, 0.05, 0);
  Pull pull = testing::make_pull(between(1.42, 2), {}, 40);
  pull.track = {{{0, {}, Ease::Smooth}, {kFrames, aside, Ease::Smooth}}};
  model.pulls = {pull};
  return model;
}

struct WorkedMotion {
  std::vector<Vec3> positions;
  FrameReport work;  ///< summed over the frames
};

WorkedMotion simulate(const SolverParams& params, int thread_count = 1) {
  Bench bench(half_moved_bar(), params, thread_count);
  EXPECT_TRUE(bench.simulator.find_equilibrium(0).ok());
  WorkedMotion motion;
  for (int frame = 1; frame <= kFrames; ++frame) {
    const FrameReport report = advance_to_frame(
        bench.simulator, frame, kFps, [] {}, [](int) {});
    EXPECT_TRUE(report.ok());
    motion.work.steps += report.steps;
    motion.work.kept_hierarchies += report.kept_hierarchies;
    motion.work.kept_matrices += report.kept_matrices;
    motion.work.linear_iterations += report.linear_iterations;
  }
  motion.positions = bench.simulator.state().positions;
  return motion;
}

SolverParams params_with(double matrix_lag, bool keep_hierarchy, double tolerance = 1e-3) {
  SolverParams params;
  params.substeps = 4;
  params.matrix_lag = matrix_lag;
  params.keep_hierarchy = keep_hierarchy;
  params.tolerance = tolerance;
  return params;
}

TEST(KeptMatrices, ChangeTheAnswerByLessThanTheTolerance) {
  const WorkedMotion kept = simulate(params_with(0.1, true)), made = simulate(params_with(0, false)),
                     exact = simulate(params_with(0, false, 1e-10));
  EXPECT_GT(kept.work.kept_matrices, 0.2 * kept.work.steps) << "half of the body hardly moves";
  EXPECT_GE(kept.work.kept_hierarchies, kFrames);
  EXPECT_EQ(made.work.kept_hierarchies, 0);
  EXPECT_LT(made.work.kept_matrices, 0.01 * made.work.steps);
  const double error = greatest_distance(made.positions, exact.positions),
               moved = greatest_distance(exact.positions, half_moved_bar().mesh.nodes);
  RecordProperty("kept", std::to_string(kept.work.kept_matrices / kept.work.steps));
  RecordProperty("error", fmt::format("{:.2e}", error / moved));
  RecordProperty("kept_error", fmt::format("{:.2e}", greatest_distance(kept.positions, exact.positions) / moved));
  EXPECT_LT(greatest_distance(kept.positions, exact.positions), 1.5 * error + 1e-5 * moved);
  EXPECT_LT(kept.work.linear_iterations, 1.2 * made.work.linear_iterations);
}

TEST(KeptMatrices, HaveTheSameBitsOnOneAndThreeThreads) {
  EXPECT_EQ(simulate(params_with(0.1, true), 1).positions, simulate(params_with(0.1, true), 3).positions);
}

/// A pin and a pull that come and go within a frame, between substeps, leave nothing in a matrix that is kept.
TEST(KeptMatrices, ForgetWhatConstraintsPutThere) {
  std::vector<Vec3> positions[2];
  for (const bool keeps : {false, true}) {
    BodyModel model = half_moved_bar();
    model.pulls[0].active = {{1, 2}};
    model.pulls[0].stiffness = testing::constant(4000.0);
    Bench bench(std::move(model), params_with(keeps ? 0.1 : 0, keeps, 1e-6));
    ASSERT_TRUE(bench.simulator.find_equilibrium(0).ok());
    double kept = 0;
    // All within frame 0 as the simulator sees it: nothing is forgotten at a frame's end.
    for (int step = 0; step < 12; ++step) {
      const StepReport report = bench.simulator.step(0.3 + 0.25 * step + (step % 4 == 3 ? 0.01 : 0.0), 1.0 / 96);
      ASSERT_TRUE(report.ok());
      kept += report.kept_rows;
    }
    EXPECT_EQ(kept > 1, keeps);
    positions[keeps ? 1 : 0] = bench.simulator.state().positions;
  }
  EXPECT_LT(greatest_distance(positions[0], positions[1]), 1e-6);
  EXPECT_GT(greatest_distance(positions[0], half_moved_bar().mesh.nodes), 1e-3);
}

}  // namespace
}  // namespace softreel
