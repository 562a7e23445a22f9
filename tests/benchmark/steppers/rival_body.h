/// What the rivals of softreel's steps know of a body: made by core, so that all of them hold the same nodes, weigh the
/// same and are pulled by the same springs.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/constraints/pins.h"
#include "core/constraints/pulls.h"
#include "core/dynamics/simulator.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/mass.h"

namespace softreel::bench {

/// Pins and pulls at the end of a step.
struct StepConstraints {
  PinnedNodes pinned;
  std::vector<ActivePull> pulls;
};

/// At rest until a step moves it. One thread.
struct RivalBody {
  RivalBody(BodyModel body_model, Dilatation dilatation);

  std::size_t nodes() const { return positions.size(); }
  /// Throws std::runtime_error if two pins want one node at different places.
  StepConstraints constraints_at(double frame) const;
  /// mass + seconds * damping of node i, kg: implicit Euler with the mass part of Rayleigh damping is implicit Euler
  /// without it of so much more mass, which gravity does not pull.
  double damped_mass(std::size_t node, double seconds) const {
    return masses.mass[node] + seconds * masses.damping[node];
  }
  /// Where inertia and gravity alone take the nodes within a step; held ones to their targets.
  std::vector<Vec3> inertial_positions(const PinnedNodes& pinned, double seconds) const;
  /// Moves the nodes; velocities are those of the way. Throws std::runtime_error, naming `method`, if a position is not
  /// finite, and leaves the state as it was.
  void move_to(std::vector<Vec3> ends, double seconds, const char* method);

  BodyModel model;
  Threads threads{1};
  ElasticBody body;
  NodalMasses masses;
  NodePins pins;
  std::vector<double> damping_stiffness;  ///< b per element, s
  std::vector<Quaternion> rotations;      ///< per element, the guess of the next extraction
  std::vector<Vec3> positions, velocities;
};

}  // namespace softreel::bench
