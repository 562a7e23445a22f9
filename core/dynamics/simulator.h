/// One body in time: rotate, assemble, update, solve (the stages of the paper's Table 1).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/base/parallel.h"
#include "core/base/timer.h"
#include "core/base/types.h"
#include "core/constraints/constraints.h"
#include "core/dynamics/recovery.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/material.h"
#include "core/multigrid/multigrid.h"
#include "core/skinning/embedding.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

struct SolverParams {
  RotationMethod rotation = RotationMethod::Consistent;
  Dilatation dilatation = Dilatation::Capped;
  bool recovery = true;             ///< of elements that stay inverted in dynamics; not with rotation None
  int substeps = 1;                 ///< per frame
  double tolerance = 1e-3;          ///< of the linear solve of a step: |r| / |b|
  double force_tolerance = 1e-6;    ///< statics: |residual force| over the force scale of the body
  int max_iterations = 400;         ///< of one linear solve
  int max_newton_iterations = 200;  ///< statics, per frame
  MultigridParams multigrid;
};

/// Everything the simulator knows of a body; immutable during a run.
struct BodyModel {
  std::string name;
  TetMesh mesh;
  std::vector<ElementMaterial> materials;  ///< per element
  std::vector<Vec3> surface_points;        ///< rest positions of the surface's vertices, m
  Embedding embedding;                     ///< of surface_points in mesh
  std::vector<Pin> pins;
  std::vector<Pull> pulls;
  Vec3 gravity = Vec3(0, -9.81, 0);  ///< m/s^2
};

/// All that changes from step to step: storing it and setting it again continues with the same bits.
struct SimulationState {
  std::vector<Vec3> positions;        ///< nodes x 3, m
  std::vector<Vec3> velocities;       ///< nodes x 3, m/s
  std::vector<Quaternion> rotations;  ///< per element, warm start of the next extraction
  ElementTroubles troubles = {};      ///< of recovery: empty while all is well
};

/// What a step did. If it could not be solved, `culprit` names the element (with its centroid) or constraint to blame.
struct StepReport {
  SolveReport solve;
  int nonlinear_iterations = 1;
  std::string culprit;
  RecoveryReport recovery = {};
  bool ok() const { return solve.ok(); }
};

/// Energies and momentum of a state, for reports and tests.
struct StateMeasures {
  double kinetic_energy = 0;             ///< J
  double elastic_energy = 0;             ///< J, of the corotated linear material with rotations at the state
  double potential_energy = 0;           ///< J, of gravity, zero at y = 0
  Vec3 linear_momentum = Vec3::Zero();   ///< kg m/s
  Vec3 angular_momentum = Vec3::Zero();  ///< kg m^2/s, about the origin
};

class Simulator {
 public:
  /// threads, log and times are kept by reference. Throws input_error if constraints contradict each other.
  Simulator(BodyModel model, const SolverParams& params, const Threads& threads, const Log& log, StageTimes& times);
  ~Simulator();

  const BodyModel& model() const;
  const SimulationState& state() const;
  void set_state(SimulationState state);

  /// One implicit Euler step of `seconds` from the present state; constraints are those at `frame`, the step's end.
  /// Nodes under a pin reach their targets exactly. On failure the state is left as it was.
  StepReport step(double frame, double seconds);

  /// Static equilibrium under the constraints at `frame`, by Newton with line search and load stepping from the present
  /// state; velocities become zero. A body without pins or pulls under no load keeps its rigid placement. On failure
  /// the state is left as it was.
  StepReport find_equilibrium(double frame);

  StateMeasures measure() const;
  /// Levels of the multigrid hierarchy, for reports.
  std::vector<LevelInfo> levels() const;

  /// Implementation, core/dynamics/simulator_parts.h.
  struct Parts;

 private:
  std::unique_ptr<Parts> parts_;
};

}  // namespace softreel
