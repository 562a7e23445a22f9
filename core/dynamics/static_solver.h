/// Newton's method for the equilibrium of a body whose held nodes are where they are, static or of a time step (design
/// 4.4).
#pragma once

#include <span>
#include <vector>

#include "core/dynamics/simulator_parts.h"
#include "core/dynamics/step_potential.h"

namespace softreel {

/// P-wave modulus, Pa: the greatest stiffness of the law where its lambda is not negative.
double p_wave_modulus(const ElasticLaw& law);

/// How the forces on some nodes balance, N.
struct ForceBalance {
  double residual = 0;   ///< norm of the unbalanced forces
  double scale = 0;      ///< norm over nodes of the summed magnitudes of the forces that balance there
  double round_off = 0;  ///< residual that the rounding of positions alone explains
};

/// Those on one piece. In statics the nodes where springs round more than all else are also told from the others: what
/// the rounding of a stiff spring explains is no balance of the rest of the body. In time steps all are others.
struct PieceBalance {
  ForceBalance all, sprung, others;
};

/// A state on the way to equilibrium, with all that the iteration compares.
struct StaticState {
  std::vector<Vec3> positions;
  std::vector<Quaternion> rotations;
  std::vector<Vec3> forces;  ///< unbalanced, N; zero on held nodes
  double energy = 0;         ///< elastic, gravity, pulls and the step's potential, J
  double energy_noise = 0;   ///< round-off of energy, that of positions included, J
  double residual = 0;       ///< norm of forces
  /// Each piece of the mesh by itself: the whole weight of a light one is little beside what a heavy one carries.
  std::vector<PieceBalance> pieces = {};
};

/// True if in each piece |forces| <= tolerance * scale, or at most `rounding` times what rounding explains, of the
/// sprung nodes and of the others alike (0: only pieces on which nothing acts are excused by that).
bool balances(const StaticState& state, double tolerance, double rounding = 0);
/// The greatest residual over its scale of a piece on which anything acts; not a number if one is none.
double imbalance(const StaticState& state);

/// One search for equilibrium under fixed constraints.
class StaticSolver {
 public:
  /// held: per node; held_pieces: by a pin, a pull or inertia; pulls: at the frame; potential: that of a time step,
  /// null in statics. Everything is kept by reference.
  StaticSolver(Simulator::Parts& parts, std::span<const std::uint8_t> held, std::span<const std::uint8_t> held_pieces,
               const std::vector<ActivePull>& pulls, const StepPotential* potential = nullptr);

  /// Moves the held nodes of `start` to `targets` by one full step of the linearised body, then iterates until
  /// the forces balance in each piece to the tolerance or round-off. The result is in `state`, converged or not.
  SolveReport solve(StaticState& state, std::span<const Vec3> targets, double tolerance, int max_iterations);

  /// Fills everything of a state but positions (rotations: guesses in, results out).
  void evaluate(StaticState& state);

  int iterations() const { return iterations_; }  ///< Newton iterations so far

 private:
  bool is_damped() const;
  bool has_rigid_parts() const;  ///< beside the softest, the stiffest material hardly deforms
  void assemble(const StaticState& state, Curvature curvature);
  void adjust_terms_to_damping(const StaticState& state, Curvature curvature);
  SolveReport solve_linear(const StaticState& state, std::span<const Vec3> right_side, double tolerance,
                           int max_iterations, std::span<Vec3> change);
  void precondition(const StaticState& state);
  void make_cycle();
  bool solve_direction(const StaticState& state, double tolerance, int max_iterations, std::vector<Vec3>& direction);
  std::vector<Vec3> forces_at(std::vector<Vec3> positions, std::vector<Quaternion> rotations);
  bool find_direction_without_energy(const StaticState& state, std::vector<Vec3>& direction);
  bool find_direction(const StaticState& state, double tolerance, std::vector<Vec3>& direction);
  bool find_stable_direction(const StaticState& state, double tolerance, std::vector<Vec3>& direction);
  bool step_along(StaticState& state, double tolerance, bool has_direction, std::vector<Vec3>& direction);
  StaticState moved(const StaticState& state, std::span<const Vec3> direction, double step);
  bool search_ahead(StaticState& state, double tolerance, std::span<const Vec3> direction);
  bool search_line(StaticState& state, std::span<const Vec3> direction);
  bool move_held(StaticState& state, std::span<const Vec3> targets);
  bool improves(const StaticState& from, const StaticState& to, double step, double slope) const;
  double add_potential(StaticState& state);
  void measure_pieces(StaticState& state);

  Simulator::Parts& parts_;
  std::span<const std::uint8_t> held_;
  std::span<const std::uint8_t> held_pieces_;
  const std::vector<ActivePull>& pulls_;
  const StepPotential* potential_;
  std::vector<double> shares_;      ///< per element: 1 and b / r of damping
  std::vector<double> node_terms_;  ///< inertia; in statics, what holds the rigid motions of pieces without a pin
  std::vector<Vec3> step_forces_;   ///< of the potential at the state that was last evaluated, N
  double stiffness_contrast_;       ///< of the stiffest material to the softest
  bool unstable_ = false;           ///< the exact tangent gave no direction of descent at the present state
  int iterations_ = 0;
  int ahead_pause_ = 1, next_ahead_ = 0;  ///< iterations to leave out after a failure of search_ahead; its next try
  int linear_iterations_ = 0;
  bool has_cycle_ = false;  ///< one that solves took few iterations with
};

}  // namespace softreel
