#include "tests/benchmark/stability/held_pose.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace softreel::bench {
namespace {

/// Moves the far end through poses: pose k is reached at frame k + 1, and stays.
Track<Transform> through(const std::vector<Transform>& poses) {
  Track<Transform> track{{{0, Transform{}, Ease::Linear}}};
  for (std::size_t k = 0; k < poses.size(); ++k)
    track.keys.push_back({static_cast<double>(k + 1), poses[k], Ease::Linear});
  return track;
}

/// Mean angle about the axis, from rest, of the nodes of each cross section, rad in (-pi, pi].
std::vector<double> section_angles(const std::vector<Vec3>& rest, const std::vector<Vec3>& positions,
                                   const Vec3& axis) {
  std::map<long, std::vector<std::size_t>> sections;
  for (std::size_t i = 0; i < rest.size(); ++i) sections[std::lround(1e6 * rest[i].x())].push_back(i);
  std::vector<double> angles;
  for (const auto& [x, members] : sections) {
    Vec3 middle = Vec3::Zero();
    for (const std::size_t i : members) middle += positions[i] / static_cast<double>(members.size());
    double sine = 0, cosine = 0;
    for (const std::size_t i : members) {
      const Vec3 a = rest[i] - axis, b = positions[i] - middle;
      cosine += a.y() * b.y() + a.z() * b.z();
      sine += a.y() * b.z() - a.z() * b.y();
    }
    angles.push_back(std::atan2(sine, cosine));
  }
  return angles;
}

/// Right while no two neighbours differ by half a turn.
double turns_of(const std::vector<double>& angles) {
  double sum = 0;
  for (std::size_t k = 1; k < angles.size(); ++k) sum += std::remainder(angles[k] - angles[k - 1], 2 * EIGEN_PI);
  return sum / (2 * EIGEN_PI);
}

std::vector<HeldPose> run_poses(const BarBody& bar, const SolverParams& params, const std::vector<Transform>& poses,
                                const PosePace& pace, Verdict& verdict) {
  Rig rig(make_bar_model(bar, through(poses)), params);
  Watch watch(rig.simulator);
  std::vector<HeldPose> measured;
  const double step = 1.0 / pace.steps_per_second;
  for (std::size_t k = 0; k < poses.size() && watch.verdict().survived(); ++k) {
    const auto end = static_cast<double>(k + 1);
    for (int part = 1; part <= pace.steps_per_second; ++part)
      watch.step(end - 1 + static_cast<double>(part) * step, step, true);
    for (int part = 0; part < pace.settle * pace.steps_per_second; ++part) watch.step(end, step);
    HeldPose pose;
    pose.flutter = measure_flutter(watch, rig.simulator, end, step, pace.steps_per_second);
    if (!watch.verdict().survived()) break;
    pose.positions = rig.simulator.state().positions;
    pose.held = turns_of(section_angles(rig.simulator.model().mesh.nodes, pose.positions, axis_of(bar)));
    measured.push_back(std::move(pose));
  }
  verdict = watch.verdict();
  return measured;
}

}  // namespace

std::vector<HeldPose> stretch_bar(const BarBody& bar, const SolverParams& params, const std::vector<double>& stretches,
                                  const PosePace& pace, Verdict& verdict) {
  std::vector<Transform> poses(stretches.size());
  for (std::size_t k = 0; k < poses.size(); ++k) poses[k].translate.x() = (stretches[k] - 1) * length_of(bar);
  std::vector<HeldPose> measured = run_poses(bar, params, poses, pace, verdict);
  for (std::size_t k = 0; k < measured.size(); ++k) measured[k].asked = stretches[k];
  return measured;
}

std::vector<HeldPose> twist_bar(const BarBody& bar, const SolverParams& params, int turns, double stretch,
                                const PosePace& pace, Verdict& verdict) {
  std::vector<Transform> poses(static_cast<std::size_t>(turns) + 1);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    poses[k].pivot = axis_of(bar);
    poses[k].translate.x() = (stretch - 1) * length_of(bar);
    poses[k].rotate.x() = 2 * EIGEN_PI * static_cast<double>(k);
  }
  std::vector<HeldPose> measured = run_poses(bar, params, poses, pace, verdict);
  for (std::size_t k = 0; k < measured.size(); ++k) measured[k].asked = static_cast<double>(k);
  return measured;
}

}  // namespace softreel::bench
