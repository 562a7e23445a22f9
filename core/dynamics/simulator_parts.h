/// What the Simulator is made of; shared by its source files only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/constraints/pins.h"
#include "core/constraints/pulls.h"
#include "core/dynamics/joints.h"
#include "core/dynamics/pieces.h"
#include "core/dynamics/simulator.h"
#include "core/elasticity/assembly.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/float_assembly.h"
#include "core/elasticity/mass.h"
#include "core/elasticity/step_terms.h"

namespace softreel {

/// How stale the coarse levels are that steps in float use: they are kept from step to step within a frame while they
/// precondition well. Every frame starts with new ones, so that a run resumed from a stored frame has the same bits.
struct CoarseLag {
  bool usable = false;             ///< the coarse levels are of an earlier step of this frame
  StepSeconds seconds;             ///< of that step
  std::vector<std::uint8_t> held;  ///< nodes that were held
  int first_iterations = 0;        ///< of the step that made them
  int last_iterations = 0;         ///< of the last step

  /// True if the next step's system is the same but for the rotations and pulls.
  bool has_same_system(const StepSeconds& step_seconds, const std::vector<std::uint8_t>& step_held) const {
    return usable && seconds == step_seconds && held == step_held;
  }
  /// True if the coarse levels need hardly more iterations than when they were made.
  bool is_fresh() const { return last_iterations <= first_iterations + 1 + first_iterations / 8; }
};

/// Under which constraints the present state was found to be at rest: while it is not stepped, there is no need to look
/// at its forces again.
struct KnownRest {
  bool known = false;  ///< false whenever the state changes
  std::vector<std::uint8_t> held;
  std::vector<ActivePull> pulls;
};

/// Diagonal of stiffness and masses around each node, by which float is judged (suits_float): sums over its neighbours.
struct RigidityOverMass {
  std::vector<float> stiffness;  ///< N/m
  std::vector<float> damping;    ///< of strain, Ns/m
  std::vector<float> mass;       ///< kg
};

/// Young's modulus per element, Pa.
std::vector<double> youngs_moduli(const std::vector<ElementMaterial>& materials);

struct Simulator::Parts {
  Parts(BodyModel body_model, const SolverParams& solver_params, const Threads& its_threads, const Log& its_log,
        StageTimes& its_times);

  BodyModel model;
  SolverParams params;
  const Threads& threads;
  const Log& log;
  StageTimes& times;

  ElasticBody body;
  NodalMasses masses;
  NodePins pins;
  std::vector<Joint> joints;  ///< those that pieces, matrix and multigrid are made for
  Pieces pieces;              ///< joints tie theirs together
  Pieces unjoined_pieces;     ///< the same without joints; empty while there are none
  BlockMatrixd matrix;
  Multigrid multigrid;
  std::vector<double> damping_stiffness;  ///< per element, s
  RigidityOverMass rigidity;              ///< empty until it is asked for
  StepSeconds float_seconds;              ///< those that float_ratio was found for
  double float_ratio = 0;                 ///< see suits_float
  AlignedVector<double> tension_limits;   ///< StepSource::tension_limits; made when first asked for
  double body_size = 0;                   ///< of the body at rest, m: what errors and rest are relative to
  SimulationState state;

  CoarseLag coarse_lag;
  KnownRest known_rest;

  // Made when first asked for: steps in float need none of what steps in double and statics do, which is a sixth of all
  // the memory of a body, and the other way round.
  std::optional<StiffnessAssembler> assembler_in_double;
  std::optional<FloatAssembler> assembler_in_float;
  const StiffnessAssembler& assembler();
  const FloatAssembler& float_assembler();

  // Reused from step to step; no result depends on what they held.
  StiffnessTerms terms;
  StepTerms step_terms;
  std::vector<Mat3> stresses;  ///< per element; empty until statics or a step in double

  std::size_t nodes() const { return model.mesh.nodes.size(); }
  /// Those that elements make by themselves.
  const Pieces& mesh_pieces() const { return joints.empty() ? pieces : unjoined_pieces; }

  /// True if an element has damping of its stiffness.
  bool damps_strain() const;
  bool has_grabs() const;
  /// What pins and pulls grab once the body has come to `frame` in the present state.
  Grabs grabs_at(double frame) const;
  /// The bonds of the glues that stick at `frame`: those of the state, and new ones for glue that starts there
  /// or comes to its next range.
  std::vector<GlueBond> bonds_at(double frame) const;
  /// Makes pieces, matrix and multigrid anew if they are not for these bonds. What is made depends on nothing else.
  void join(const std::vector<GlueBond>& bonds);
  /// Pulls at a frame that grab what `grabs` says, and the springs of the bonds.
  std::vector<ActivePull> pulls_at(double frame, const Grabs& grabs, const std::vector<GlueBond>& bonds) const;
  /// Gravity, elasticity (of `stresses`) and pulls on the nodes, N.
  void gather_all_forces(std::span<const Vec3> positions, const std::vector<ActivePull>& pulls,
                         std::span<Vec3> forces) const;
  /// 1 per piece that a pin or pull holds.
  std::vector<std::uint8_t> held_pieces(const PinnedNodes& pinned, const std::vector<ActivePull>& pulls) const;
  /// Names the first element whose shape is not finite; else the first pull active at `frame` whose force is not; else
  /// the first element whose entries of `blame` are not, or that with the greatest.
  std::string find_culprit(double frame, std::span<const Vec3> positions, std::span<const Vec3> blame) const;
  std::string find_boundless_pull(double frame, std::span<const Vec3> positions) const;
  /// Names the first glue that sticks at `frame` and is so stiff that solves may end for its sake; empty if there is
  /// none.
  std::string find_stiff_glue(double frame) const;
  std::string describe_element(std::size_t element) const;

  StepReport step(double frame, double seconds, double error_limit);
  StepReport find_equilibrium(double frame);
};

}  // namespace softreel
