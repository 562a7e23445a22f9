#include "tests/benchmark/stability/watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/LU>
#include <fmt/format.h>

#include "core/constraints/pulls.h"
#include "core/elasticity/winding.h"

namespace softreel::bench {
namespace {

constexpr double kDegrees = 180 / EIGEN_PI;

bool all_finite(const std::vector<Vec3>& vectors) {
  return std::all_of(vectors.begin(), vectors.end(), [](const Vec3& v) { return v.allFinite(); });
}

}  // namespace

bool is_finite(const SimulationState& state) {
  return all_finite(state.positions) && all_finite(state.velocities) &&
         std::all_of(state.rotations.begin(), state.rotations.end(),
                     [](const Quaternion& q) { return q.coeffs().allFinite(); });
}

Watch::Watch(Simulator& simulator, int stride) : simulator_(simulator), stride_(stride) {
  const BodyModel& model = simulator.model();
  Vec3 low = model.mesh.nodes[0], high = low;
  for (const Vec3& p : model.mesh.nodes) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  radius_ = 0.5 * (high - low).norm();
  for (std::size_t e = 0; e < model.mesh.tets.size(); ++e) {
    const TetNodes rest = nodes_of(model.mesh.tets[e], model.mesh.nodes);
    mass_ += model.materials[e].density * tet_volume(rest[0], rest[1], rest[2], rest[3]);
  }
  restart();
}

Watch::Energies Watch::look(double frame) const {
  const BodyModel& model = simulator_.model();
  Energies energies{0, 0, simulator_.measure()};
  energies.scale = energies.measures.kinetic_energy + energies.measures.elastic_energy;
  for (const ActivePull& pull : active_pulls(model.pulls, model.surface_points, model.embedding, model.mesh, frame))
    energies.scale += pull_energy(pull, simulator_.state().positions);
  energies.total = energies.scale + energies.measures.potential_energy;
  return energies;
}

void Watch::restart() {
  const Energies energies = look(0);
  energy_ = energies.total;
  greatest_energy_ = energies.scale;
  greatest_kinetic_ = energies.measures.kinetic_energy;
  linear_ = energies.measures.linear_momentum;
  angular_ = energies.measures.angular_momentum;
}

void Watch::judge(double frame, bool energy_counts) {
  const Energies now = look(frame);
  if (energy_counts) {
    // A body that starts at rest has no energy, or rounding's, to compare with before its first step.
    const double scale = verdict_.steps == 1 ? std::max(greatest_energy_, now.scale) : greatest_energy_;
    const double gain = scale > 0 ? (now.total - energy_) / scale : 0.0;
    verdict_.gains += gain > kNoise ? 1 : 0;
    if (!(gain <= verdict_.worst_gain)) verdict_.worst_gain = gain;
  }
  energy_ = now.total;
  motion_energy_ = now.scale;
  greatest_energy_ = std::max(greatest_energy_, now.scale);
  greatest_kinetic_ = std::max(greatest_kinetic_, now.measures.kinetic_energy);
  const double momentum = std::sqrt(2 * mass_ * greatest_kinetic_);
  if (momentum == 0) return;
  const double linear = (now.measures.linear_momentum - linear_).norm() / momentum;
  const double angular = (now.measures.angular_momentum - angular_).norm() / (momentum * radius_);
  verdict_.linear_drift = std::max(verdict_.linear_drift, linear);
  verdict_.angular_drift = std::max(verdict_.angular_drift, angular);
}

bool Watch::step(double frame, double seconds, bool pins_work, bool judge_recovery) {
  if (!verdict_.survived()) return false;
  last_ = simulator_.step(frame, seconds);
  if (!last_.ok()) {
    verdict_.failure = fmt::format("step {}: {}", verdict_.steps + 1, last_.culprit);
    return false;
  }
  ++verdict_.steps;
  verdict_.finite = is_finite(simulator_.state());
  if (!verdict_.finite) {
    verdict_.failure = fmt::format("step {}: no number", verdict_.steps);
    return false;
  }
  if (verdict_.steps % stride_ == 0) judge(frame, !pins_work && (judge_recovery || last_.recovery.elements == 0));
  return true;
}

double measure_flutter(Watch& watch, Simulator& simulator, double frame, double seconds, int steps) {
  const Threads threads(1);
  const ElasticBody body = make_elastic_body(simulator.model().mesh, simulator.model().materials, Dilatation::Capped);
  std::vector<Quaternion> before = simulator.state().rotations;
  find_rotations(body, RotationMethod::Consistent, simulator.state().positions, before, threads);
  std::vector<double> angles(before.size(), 0);
  for (int k = 0; k < steps; ++k) {
    if (!watch.step(frame, seconds)) return std::numeric_limits<double>::quiet_NaN();
    if (watch.last().at_rest) continue;
    std::vector<Quaternion> after = before;
    find_rotations(body, RotationMethod::Consistent, simulator.state().positions, after, threads);
    for (std::size_t e = 0; e < angles.size(); ++e) angles[e] += before[e].angularDistance(after[e]);
    before = std::move(after);
  }
  return kDegrees * *std::max_element(angles.begin(), angles.end()) / steps;
}

Leftovers find_leftovers(const Simulator& simulator) {
  const BodyModel& model = simulator.model();
  const std::vector<Vec3>& positions = simulator.state().positions;
  const ElasticBody body = make_elastic_body(model.mesh, model.materials, Dilatation::Capped);
  Leftovers left;
  std::vector<Index> all(body.tets.size());
  std::iota(all.begin(), all.end(), 0);
  for (std::size_t e = 0; e < body.tets.size(); ++e)
    left.inverted +=
        deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], positions)).determinant() < 0 ? 1 : 0;
  left.wound = static_cast<Index>(find_wound_elements(body, positions, all).size());
  return left;
}

}  // namespace softreel::bench
