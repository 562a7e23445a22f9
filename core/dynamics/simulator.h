/// One body in time: rotate, assemble, update, solve (the stages of the paper's Table 1).
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "core/base/parallel.h"
#include "core/base/timer.h"
#include "core/base/types.h"
#include "core/constraints/constraints.h"
#include "core/constraints/glue.h"
#include "core/dynamics/recovery.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/material.h"
#include "core/multigrid/multigrid.h"
#include "core/skinning/embedding.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// How a step is taken (design 4.4): of first order, of second order with damping of what is too fast for the step, or
/// of second order without (at NewmarkParams' defaults). Stored results are keyed by the numbers: new ones go last.
enum class Integrator { Euler, Bdf2, Newmark };

/// At gamma = 1/2 of second order, above it damped and of first; stable for any step if 2 beta >= gamma >= 1/2.
struct NewmarkParams {
  double beta = 0.25, gamma = 0.5;
  bool is_stable() const { return gamma >= 0.5 && 2 * beta >= gamma; }
};

/// How often a step linearises, and where it takes rotations and forces (design 4.4). Keyed as above.
enum class Linearize {
  Auto,       ///< Start for Euler, Predictor for BDF2, Iterated for Newmark, which damps nothing that one solve leaves
  Start,      ///< once, at the step's start, as in the paper: of first order, whatever the integrator
  Predictor,  ///< once, where the step should end (linearization_positions): keeps the integrator's order
  Iterated    ///< Newton with line search until all forces balance at the step's end
};

struct SolverParams {
  RotationMethod rotation = RotationMethod::Consistent;
  Dilatation dilatation = Dilatation::Capped;
  Integrator integrator = Integrator::Euler;
  NewmarkParams newmark;
  Linearize linearize = Linearize::Auto;
  bool recovery = true;     ///< of elements that stay inverted in dynamics; not with rotation None
  int substeps = 1;         ///< per frame; with step_error, the fewest
  double step_error = 0;    ///< largest estimated error of a step over the body's size; 0: steps are fixed
  int max_substeps = 1024;  ///< per frame, with step_error
  /// A body at rest is not stepped: one whose nodes would all move less than this times its size in 1/24 s, whose
  /// forces balance to force_tolerance in each piece and whose pins do not move. 0: every body is stepped.
  double rest_tolerance = 1e-7;
  /// Within a frame, elements whose matrix would change by less than this times `tolerance` since it was made keep it.
  double matrix_lag = 0.1;
  bool keep_hierarchy = true;     ///< within a frame, while iteration counts do not grow; else made anew at every step
  double tolerance = 1e-3;        ///< of the linear solve of a step: |r| / |b|; tighter by itself for very stiff parts
  double force_tolerance = 1e-6;  ///< statics, iterated steps: |residual force| over the force scale of the body
  int max_iterations = 400;       ///< of one linear solve
  int max_newton_iterations = 200;  ///< statics, per frame; iterated steps, per step
  MultigridParams multigrid;
};

/// What Linearize::Auto stands for.
Linearize linearization(const SolverParams& params);

/// One of the bodies of a model that holds several: its nodes and elements are those from these on.
struct BodyPart {
  std::string name;
  Index first_node = 0, first_tet = 0;
};

/// Everything the simulator knows of a body, or of several that glue joins (joined_model.h); immutable during a run.
struct BodyModel {
  std::string name;
  TetMesh mesh;
  std::vector<ElementMaterial> materials;  ///< per element
  std::vector<Vec3> surface_points;        ///< rest positions of the surface's vertices, m
  Embedding embedding;                     ///< of surface_points in mesh
  std::vector<Pin> pins;
  std::vector<Pull> pulls;
  Vec3 gravity = Vec3(0, -9.81, 0);  ///< m/s^2
  std::vector<BodyPart> parts = {};  ///< in order; empty: all is one body
  std::vector<Glue> glues = {};
};

/// All that changes from step to step: storing it and setting it again continues with the same bits. After the
/// rotations comes what integrator and solver remember: empty and 0 before the first step and where nothing needs it.
struct SimulationState {
  std::vector<Vec3> positions;                 ///< nodes x 3, m
  std::vector<Vec3> velocities;                ///< nodes x 3, m/s
  std::vector<Quaternion> rotations;           ///< per element, warm start of the next extraction
  std::vector<Vec3> previous_positions{};      ///< BDF2, Newmark that damps strain: before the last step, m
  std::vector<Vec3> previous_velocities{};     ///< BDF2: before the last step, m/s
  std::vector<Vec3> accelerations{};           ///< nodes x 3, m/s^2: Newmark's, and the next solve's first guess
  std::vector<Vec3> previous_accelerations{};  ///< before the last step: how the guess changes
  double previous_error = 0;                   ///< error control: of the last step, over the body's size
  double previous_seconds = 0;                 ///< BDF2, Newmark, error control: length of the last step
  std::uint64_t constraints = 0;               ///< BDF2, Newmark: fingerprint of which held and pulled in the last step
  ElementTroubles troubles = {};               ///< of recovery: empty while all is well
  Grabs grabs = {};                            ///< of pins and pulls that grab
  std::vector<GlueBond> bonds = {};            ///< of the glues that stick, ascending by glue and point
};

/// What a step did. If it could not be solved, `culprit` names the element (with its centroid) or constraint to blame.
struct StepReport {
  SolveReport solve;
  int nonlinear_iterations = 1;
  double error = 0;             ///< estimated, of the positions, over the body's size
  bool rejected = false;        ///< the error is above the limit: the state was left as it was
  bool at_rest = false;         ///< nothing was to be done: the state was left as it was
  bool kept_hierarchy = false;  ///< the coarse levels are those of an earlier step
  double kept_rows = 0;         ///< share of the matrix that was left as it was, 0 to 1
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
  const SolverParams& params() const;
  const SimulationState& state() const;
  /// The integrator's memory may be empty; then the next step is taken as a first one.
  void set_state(SimulationState state);

  /// Pins and pulls that grab and are on at `frame` take what the present state has, if they have not yet: to be called
  /// where steps start from a state at that frame without a history. Steps and equilibria do so by themselves.
  void start_grabs(double frame);

  /// One step of `seconds` from the present state; constraints are those at `frame`, the step's end. Nodes under a pin
  /// reach their targets exactly. On failure the state is left as it was; pins that contradict each other there are an
  /// input_error. BDF2's first step, and its first after a pin or pull began or let go, is one of two stages
  /// (kFirstStage of time_step.h); Newmark's starts from the acceleration that the forces give then. A body at rest is
  /// left as it is, to the last bit.
  ///
  /// error_limit: over the body's size. The error is that of the integrator, estimated from the distance between the
  /// step's end and the predictor of x + h v + h^2 a / 2 (Euler: x + h v); what Linearize::Start adds to it for an
  /// integrator of second order is not in it.
  StepReport step(double frame, double seconds, double error_limit = std::numeric_limits<double>::infinity());

  /// Static equilibrium under the constraints at `frame`, by Newton with line search and load stepping from the present
  /// state; velocities become zero. What grabs and starts at this frame grabs the present state. A body without pins or
  /// pulls under no load keeps its rigid placement. On failure the state is left as it was.
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
