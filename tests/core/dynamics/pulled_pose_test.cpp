/// Pulls accumulate and hold a pose, as in the paper's figure 5: a body fixed at one end is brought into a pose by one
/// pull after the other, each of which stays.
#include <cmath>

#include <gtest/gtest.h>

#include "core/constraints/pulls.h"
#include "core/elasticity/elastic_body.h"
#include "tests/core/dynamics/dynamics_support.h"

namespace softreel {
namespace {

using testing::Bench;
using testing::greatest_distance;

/// Stiff ends and a soft knee between them, held at the low end; a pull on the knee from frame 2 and one on the other
/// end from frame 3.
BodyModel posed_leg() {
  BodyModel model = testing::body_model(testing::kuhn_bar({12, 3, 3}, Vec3(1.2, 0.3, 0.3)), {1e6, 0.3, 1000, 2, 0.01});
  for (std::size_t e = 0; e < model.mesh.tets.size(); ++e)
    if (std::abs(testing::centroid(model.mesh, e).x() - 0.6) < 0.15) model.materials[e].youngs_modulus = 1e5;
  const auto near = [&](double x) {
    return testing::select_nodes(model.mesh, [x](const Vec3& p) { return std::abs(p.x() - x) < 0.05; });
  };
  Transform up, folded;
  up.translate = Vec3(0, 0.2, 0);
  folded.translate = Vec3(-0.3, -0.2, 0);
  model.pins = {testing::make_pin(near(0))};
  model.pulls = {testing::make_pull(near(0.6), up, 3e4), testing::make_pull(near(1.2), folded, 3e3)};
  model.pulls[0].active = {{2, 1000}};
  model.pulls[1].active = {{3, 1000}};
  model.pulls[1].name = "body.bar.pull[1]";
  return model;
}

std::vector<Vec3> forces_of(const BodyModel& model, const Pull& pull, double frame,
                            const std::vector<Vec3>& positions) {
  std::vector<Vec3> forces(positions.size(), Vec3::Zero());
  for (const ActivePull& active : active_pulls({pull}, model.surface_points, model.embedding, model.mesh, frame))
    add_pull_forces(active, positions, forces);
  return forces;
}

TEST(PulledPose, BalancesTheSumOfAllPullsThatWereAdded) {
  const BodyModel model = posed_leg();
  Bench bench(model, testing::exact_params());
  std::vector<std::vector<Vec3>> poses;
  for (int frame = 1; frame <= 3; ++frame) {
    ASSERT_TRUE(bench.simulator.find_equilibrium(frame).ok());
    poses.push_back(bench.simulator.state().positions);
  }
  EXPECT_GT(greatest_distance(poses[1], poses[0]), 0.02) << "the first pull moves it";
  EXPECT_GT(greatest_distance(poses[2], poses[1]), 0.02) << "so does the second";
  const std::vector<Vec3>& pose = poses[2];
  const ElasticBody body = make_elastic_body(model.mesh, model.materials, Dilatation::Capped);
  std::vector<Quaternion> rotations = bench.simulator.state().rotations;
  std::vector<Mat3> stresses(body.tets.size());
  std::vector<Vec3> elastic(pose.size());
  const Threads threads(1);
  find_rotations(body, RotationMethod::Consistent, pose, rotations, threads);
  find_stresses(body, pose, rotations, stresses, threads);
  gather_forces(body, stresses, elastic, threads);
  const std::vector<Vec3> first = forces_of(model, model.pulls[0], 3, pose),
                          second = forces_of(model, model.pulls[1], 3, pose);
  std::vector<double> mass(pose.size(), 0);
  for (std::size_t e = 0; e < body.tets.size(); ++e)
    for (const Index node : body.tets[e]) mass[static_cast<std::size_t>(node)] += 250 * body.shapes[e].volume;
  double scale = 0, unbalanced = 0, without_second = 0;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (model.mesh.nodes[i].x() < 0.15) continue;  // the pin's elements carry what is left over
    const Vec3 rest = elastic[i] + mass[i] * model.gravity + first[i];
    scale = std::max(scale, elastic[i].norm());
    without_second = std::max(without_second, rest.norm());
    unbalanced = std::max(unbalanced, (rest + second[i]).norm());
  }
  EXPECT_LT(unbalanced, 1e-8 * scale);
  EXPECT_GT(without_second, 1e-2 * scale);
}

TEST(PulledPose, StaysWhileThePullsStayAndLeavesWithTheFirstThatEnds) {
  BodyModel model = posed_leg();
  model.pulls[0].active = {{2, 23}};
  Bench bench(model, testing::exact_params());
  ASSERT_TRUE(bench.simulator.find_equilibrium(3).ok());
  const std::vector<Vec3> pose = bench.simulator.state().positions;
  for (int frame = 4; frame <= 23; ++frame) ASSERT_TRUE(bench.simulator.step(frame, 1.0 / 24).ok());
  EXPECT_LT(greatest_distance(bench.simulator.state().positions, pose), 1e-8);
  for (int frame = 24; frame <= 30; ++frame) ASSERT_TRUE(bench.simulator.step(frame, 1.0 / 24).ok());
  EXPECT_GT(greatest_distance(bench.simulator.state().positions, pose), 0.02);
}

}  // namespace
}  // namespace softreel
