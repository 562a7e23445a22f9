#include "tests/support/scrambled.h"

#include <algorithm>
#include <stdexcept>

#include "core/elasticity/element_rotation.h"
#include "tests/support/bcc_bar.h"
#include "tests/support/elastic_box.h"

namespace softreel::testing {
namespace {

constexpr double kBack = 1e-3;

Vec3 random_unit(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

Vec3 center_of(const std::vector<Vec3>& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

double size_of(const std::vector<Vec3>& points) {
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

std::vector<Vec3> in_box(const std::vector<Vec3>& rest, std::mt19937_64& random) {
  Vec3 low = rest[0], high = rest[0];
  for (const Vec3& p : rest) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < rest.size(); ++i)
    positions.push_back(low + (high - low).cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random))));
  return positions;
}

/// The rest shape under a linear map about its centre.
std::vector<Vec3> mapped(const std::vector<Vec3>& rest, const Mat3& map) {
  const Vec3 center = center_of(rest);
  std::vector<Vec3> positions;
  for (const Vec3& p : rest) positions.push_back(center + map * (p - center));
  return positions;
}

}  // namespace

const std::vector<Scramble>& scrambles() {
  using Rest = const std::vector<Vec3>&;
  using Random = std::mt19937_64&;
  static const std::vector<Scramble> all{
      {"box", in_box},
      {"plane",
       [](Rest rest, Random random) {
         const Vec3 n = random_unit(random);
         return mapped(rest, Mat3::Identity() - n * n.transpose());
       }},
      {"line",
       [](Rest rest, Random random) {
         const Vec3 n = random_unit(random);
         return mapped(rest, n * n.transpose());
       }},
      {"point", [](Rest rest, Random) { return mapped(rest, Mat3::Zero()); }},
      {"mirror",
       [](Rest rest, Random random) {
         const Vec3 n = random_unit(random);
         return mapped(rest, Mat3::Identity() - 2 * n * n.transpose());
       }},
  };
  return all;
}

BodyModel scramble_model(Index across) {
  BodyModel model;
  model.name = "body.box";
  model.mesh = test_support::make_box({across + 1, across, across}, 0.1);
  model.materials.assign(model.mesh.tets.size(), {1e5, 0.35, 1000, 2, 0.01});
  model.surface_points = model.mesh.nodes;
  model.embedding = embed_nodes(model.mesh);
  model.gravity.setZero();
  return model;
}

double distance_from_rigid(const std::vector<Vec3>& rest, const std::vector<Vec3>& positions) {
  const Vec3 from = center_of(rest), to = center_of(positions);
  Mat3 moment = Mat3::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) moment += (positions[i] - to) * (rest[i] - from).transpose();
  const Quaternion rotation = find_rotation(moment, Quaternion::Identity());
  double greatest = 0;
  for (std::size_t i = 0; i < rest.size(); ++i)
    greatest = std::max(greatest, (positions[i] - to - rotation * (rest[i] - from)).norm());
  return greatest;
}

bool is_back(const std::vector<Vec3>& rest, const std::vector<Vec3>& positions) {
  return distance_from_rigid(rest, positions) <= kBack * size_of(rest);
}

Release release(BodyModel model, const Scramble& scramble, RotationMethod rotation, bool recovery, int seed,
                int most_steps) {
  const Threads threads(1);
  const Log log;
  StageTimes times;
  SolverParams params;
  params.rotation = rotation;
  params.recovery = recovery;
  const std::vector<Vec3> rest = model.mesh.nodes;
  Simulator simulator(std::move(model), params, threads, log, times);
  SimulationState state = simulator.state();
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  state.positions = scramble.positions(rest, random);
  simulator.set_state(state);
  Release result;
  for (int step = 1; step <= most_steps; ++step) {
    const StepReport report = simulator.step(step, 1.0 / 24);
    if (!report.ok()) throw std::runtime_error("a step was not solved: " + report.culprit);
    result.most_elements = std::max(result.most_elements, report.recovery.elements);
    result.steps = step;
    if (!is_back(rest, simulator.state().positions)) continue;
    result.came_back = true;
    break;
  }
  return result;
}

}  // namespace softreel::testing
