#include "tests/benchmark/steppers/rival_body.h"

#include <stdexcept>

#include <fmt/format.h>

namespace softreel::bench {

RivalBody::RivalBody(BodyModel body_model, Dilatation dilatation)
    : model(std::move(body_model)),
      body(make_elastic_body(model.mesh, model.materials, dilatation)),
      masses(lump_masses(model.mesh, model.materials)),
      pins(model.pins, model.embedding, model.mesh),
      rotations(model.mesh.tets.size(), Quaternion::Identity()),
      positions(model.mesh.nodes),
      velocities(model.mesh.nodes.size(), Vec3::Zero()) {
  damping_stiffness.reserve(model.materials.size());
  for (const ElementMaterial& material : model.materials) damping_stiffness.push_back(material.damping_stiffness);
}

StepConstraints RivalBody::constraints_at(double frame) const {
  StepConstraints constraints{pins.at(frame),
                              active_pulls(model.pulls, model.surface_points, model.embedding, model.mesh, frame)};
  if (!constraints.pinned.conflict.empty()) throw std::runtime_error(constraints.pinned.conflict);
  return constraints;
}

std::vector<Vec3> RivalBody::inertial_positions(const PinnedNodes& pinned, double seconds) const {
  std::vector<Vec3> ends(nodes());
  for (std::size_t i = 0; i < nodes(); ++i) {
    const Vec3 velocity = masses.mass[i] / damped_mass(i, seconds) * (velocities[i] + seconds * model.gravity);
    ends[i] = pinned.held[i] != 0 ? pinned.targets[i] : Vec3(positions[i] + seconds * velocity);
  }
  return ends;
}

void RivalBody::move_to(std::vector<Vec3> ends, double seconds, const char* method) {
  for (std::size_t i = 0; i < nodes(); ++i)
    if (!ends[i].allFinite()) throw std::runtime_error(fmt::format("{}: the place of node {} is no number", method, i));
  for (std::size_t i = 0; i < nodes(); ++i) velocities[i] = (ends[i] - positions[i]) / seconds;
  positions = std::move(ends);
}

}  // namespace softreel::bench
