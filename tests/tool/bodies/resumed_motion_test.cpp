/// A motion that goes on from stored frames is, to the last bit, the one that was never stopped: with matrices and
/// coarse levels that are kept from step to step, and with the stiffness of tension in them.
#include <gtest/gtest.h>

#include "core/dynamics/frame_steps.h"
#include "core/elasticity/tension.h"
#include "core/elasticity/thickness.h"
#include "tests/core/dynamics/dynamics_support.h"
#include "tool/bodies/body_frame_bytes.h"

namespace softreel {
namespace {

constexpr double kFps = 24;
constexpr int kSubsteps = 4;
constexpr int kFrames = 9;

/// A bar that is clamped in the middle: one half rests, the other is drawn to one and a half times its length.
BodyModel half_drawn_bar() {
  BodyModel model = testing::body_model(testing::bcc_bar({4, 4, 40}, 0.025), {1e6, 0.35, 1000, 0.5, 0.005});
  const auto between = [&](double low, double high) {
    return testing::select_nodes(model.mesh, [=](const Vec3& p) { return p.z() > low && p.z() < high; });
  };
  model.gravity.setZero();
  model.pins = {testing::make_pin(between(0.45, 0.55))};
  Transform away;
  away.translate = Vec3(0.03, 0, 0.24);
  Pull pull = testing::make_pull(between(0.95, 1), {}, 1e6);
  pull.track = {{{0, {}, Ease::Smooth}, {5, away, Ease::Smooth}}};
  model.pulls = {pull};
  return model;
}

SolverParams keeping() {
  SolverParams params;
  params.substeps = kSubsteps;
  params.matrix_lag = 0.1;
  params.keep_hierarchy = true;
  return params;
}

/// True if a step from this state has tension that its matrix must know of.
bool needs_tension(const BodyModel& model, const SimulationState& state) {
  const Threads threads(1);
  const double h = 1 / (kFps * kSubsteps);
  const ElasticBody body = make_elastic_body(model.mesh, model.materials, Dilatation::Capped);
  std::vector<double> moduli, damping;
  for (const ElementMaterial& material : model.materials) {
    moduli.push_back(material.youngs_modulus);
    damping.push_back(material.damping_stiffness);
  }
  const BlockPattern pattern = stiffness_pattern(model.mesh.tets, static_cast<Index>(model.mesh.nodes.size()));
  const AlignedVector<double> limits =
      find_tension_limits(body, find_thickness(model.mesh, pattern, moduli), model.materials, 0.5);
  std::vector<Quaternion> rotations = state.rotations;
  find_rotations(body, RotationMethod::Consistent, state.positions, rotations, threads);
  return !find_tension_curvatures(body, {state.positions, {}, rotations, {h, h}, damping, {}, -1, limits}, threads)
              .empty();
}

/// Frames after `from`, whose bytes are `stored`, as the cache would have them; empty: from rest at frame 0.
std::vector<Bytes> frames_after(int from, const Bytes& stored, double& kept_matrices, double& kept_hierarchies) {
  testing::Bench bench(half_drawn_bar(), keeping());
  if (!stored.empty()) bench.simulator.set_state(unpack_body_frame(stored).state);
  std::vector<Bytes> frames;
  for (int frame = from + 1; frame <= kFrames; ++frame) {
    const FrameReport report = advance_to_frame(
        bench.simulator, frame, kFps, [] {}, [](int) {});
    EXPECT_TRUE(report.ok()) << frame << " " << report.last.culprit;
    kept_matrices += report.kept_matrices;
    kept_hierarchies += report.kept_hierarchies;
    BodyFrame made;
    made.state = bench.simulator.state();
    frames.push_back(pack(made));
  }
  return frames;
}

TEST(ResumedMotion, HasTheBitsOfOneThatWasNotStoppedWithKeptMatricesAndTension) {
  double kept_matrices = 0, kept_hierarchies = 0;
  const std::vector<Bytes> through = frames_after(0, {}, kept_matrices, kept_hierarchies);
  EXPECT_GT(kept_matrices, 0.1 * kFrames * kSubsteps) << "the half at rest keeps its rows";
  EXPECT_GE(kept_hierarchies, kFrames);
  const BodyModel model = half_drawn_bar();
  for (const int from : {1, 4, 8}) {
    const Bytes& stored = through[static_cast<std::size_t>(from - 1)];
    if (from > 1) {
      EXPECT_TRUE(needs_tension(model, unpack_body_frame(stored).state)) << from;
    }
    const std::vector<Bytes> resumed = frames_after(from, stored, kept_matrices, kept_hierarchies);
    for (std::size_t i = 0; i < resumed.size(); ++i)
      EXPECT_EQ(resumed[i], through[static_cast<std::size_t>(from) + i])
          << "frame " << from + 1 + i << " from " << from;
  }
}

}  // namespace
}  // namespace softreel
