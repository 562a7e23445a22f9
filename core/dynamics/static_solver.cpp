#include "core/dynamics/static_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/dynamics/flexible_gmres.h"
#include "core/dynamics/inner_product.h"
#include "core/dynamics/linear_system.h"
#include "core/dynamics/pin_motion.h"
#include "core/dynamics/rigid_modes.h"

namespace softreel {
namespace {

constexpr int kIndefiniteIterations =
    100;                                  ///< of a solve that may be indefinite: with its cycle a definite one takes 30
constexpr double kNearer = 0.5;           ///< residual of an unfinished linear solve whose result is still of use
constexpr int kGmresIterations = 30;      ///< where the tangent is not symmetric; they keep 60 vectors
constexpr double kInnerTolerance = 0.03;  ///< of the solves that precondition them
constexpr double kDifferenceStep = 1e-7;  ///< of positions, over the size of a tetrahedron: between bend and round-off
constexpr double kWorstLinearTolerance = 1e-3;
/// A cycle that takes more iterations is made anew each time; another costs about as much as four of them.
constexpr int kMostOfLagging = 8;
constexpr double kBestLinearTolerance = 1e-10;
/// Stiffness against rigid motion of pieces without a pin, relative to the mean stiffness of a node: far below the
/// softest deformation of any mesh that fits in memory, far above round-off.
constexpr double kRigidShift = 1e-7;
constexpr std::int64_t kElementGrain = 1024;

/// What rounding explains is an upper bound: linear solves go on to this share of it. Steps of time, whose stiff parts
/// move rigidly, come to a twentieth of it or less.
constexpr double kStaticFloor = 0.1, kStepFloor = 0.01;
/// Iterations of a step in a row that may end below that bound without having halved the residual.
constexpr int kStalls = 2;

/// Stiffness over the softest of the body from which on a part is as good as rigid: at 1e5 a hanging bar half of which
/// was so stiff took 57 iterations and at 1e6 125 that searched along the line only; with full steps ahead 6 and 9.
constexpr double kRigidContrast = 1e5;
/// Up to which the cycle of one state of a step serves the next: where stiff parts turn in soft ones, it does not (the
/// preset soft_knees took up to 775 iterations a frame instead of 230).
constexpr double kLaggingContrast = 10;

/// The stiffest of a body's materials over the softest.
double stiffness_contrast(std::span<const ElasticLaw> laws) {
  double softest = std::numeric_limits<double>::infinity(), stiffest = 0;
  for (const ElasticLaw& law : laws) {
    softest = std::min(softest, p_wave_modulus(law));
    stiffest = std::max(stiffest, p_wave_modulus(law));
  }
  return stiffest / softest;
}

/// True if no position would change by more than its rounding.
bool is_negligible(std::span<const Vec3> direction, std::span<const Vec3> positions) {
  for (std::size_t i = 0; i < direction.size(); ++i)
    if (!(direction[i].norm() <= std::numeric_limits<double>::epsilon() * positions[i].norm())) return false;
  return true;
}

/// Of the pieces, or their sprung or other nodes, that are above theirs; of all, if none is.
double least_round_off(const StaticState& state) {
  double least = std::numeric_limits<double>::infinity(), of_all = 0;
  for (const PieceBalance& piece : state.pieces) {
    for (const ForceBalance& nodes : {piece.all, piece.sprung, piece.others})
      if (nodes.residual > nodes.round_off) least = std::min(least, nodes.round_off);
    of_all = std::hypot(of_all, piece.all.round_off);
  }
  return std::min(least, of_all);
}

bool is_positive(double x) {
  return x > 0;  // false for not a number
}

/// Mass proportional, so that a free piece has its centre of mass where it was; nothing on pieces that a pin holds,
/// which holds a whole tetrahedron and with it every rigid motion. Glue may hold by a point or two: a piece that only
/// it ties to a held one is not held by it.
std::vector<double> rigid_shifts(const Simulator::Parts& parts, std::span<const std::uint8_t> held) {
  const Pieces& own = parts.mesh_pieces();
  const auto piece = [&](Index node) { return static_cast<std::size_t>(own.of_node[static_cast<std::size_t>(node)]); };
  std::vector<std::uint8_t> fixed(static_cast<std::size_t>(own.count), 0);
  for (std::size_t i = 0; i < held.size(); ++i)
    if (held[i] != 0) fixed[piece(static_cast<Index>(i))] = 1;
  // Of each piece by itself: what is little to a stiff one may be more than a soft one resists with.
  std::vector<double> stiffness(fixed.size(), 0), mass(fixed.size(), 0);
  for (std::size_t e = 0; e < parts.body.tets.size(); ++e) {
    const ElementShape& shape = parts.body.shapes[e];
    stiffness[piece(parts.body.tets[e][0])] +=
        shape.volume * p_wave_modulus(parts.body.laws[e]) * shape.gradients.squaredNorm();
  }
  for (std::size_t i = 0; i < held.size(); ++i) mass[piece(static_cast<Index>(i))] += parts.masses.mass[i];
  std::vector<double> shifts(held.size(), 0);
  for (std::size_t i = 0; i < held.size(); ++i) {
    const std::size_t p = piece(static_cast<Index>(i));
    if (fixed[p] == 0 && mass[p] > 0) shifts[i] = kRigidShift * stiffness[p] / mass[p] * parts.masses.mass[i];
  }
  return shifts;
}

}  // namespace

StaticSolver::StaticSolver(Simulator::Parts& parts, std::span<const std::uint8_t> held,
                           std::span<const std::uint8_t> held_pieces, const std::vector<ActivePull>& pulls,
                           const StepPotential* potential)
    : parts_(parts),
      held_(held),
      held_pieces_(held_pieces),
      pulls_(pulls),
      potential_(potential),
      shares_(parts.body.tets.size(), 1.0),
      node_terms_(potential != nullptr ? potential->weights : rigid_shifts(parts, held)),
      stiffness_contrast_(stiffness_contrast(parts.body.laws)) {
  parts_.stresses.resize(parts.body.tets.size());
  if (is_damped())
    for (std::size_t e = 0; e < shares_.size(); ++e) shares_[e] += potential->damping.ratios[e];
}

/// Adds the step's forces to those of the state; returns its energy.
double StaticSolver::add_potential(StaticState& state) {
  if (potential_ == nullptr) return 0;
  step_forces_.resize(state.positions.size());
  const DampingEnergy energy =
      potential_->evaluate(parts_.body, state.positions, state.rotations, step_forces_, parts_.threads);
  for (std::size_t i = 0; i < step_forces_.size(); ++i) state.forces[i] += step_forces_[i];
  state.energy_noise = energy.noise;
  return energy.value;
}

void StaticSolver::evaluate(StaticState& state) {
  {
    const ScopedStage stage(parts_.times, "simulate/rotate");
    find_rotations(parts_.body, parts_.params.rotation, state.positions, state.rotations, parts_.threads);
  }
  const ScopedStage stage(parts_.times, "simulate/assemble");
  state.forces.resize(state.positions.size());
  find_stresses(parts_.body, state.positions, state.rotations, parts_.stresses, parts_.threads);
  parts_.gather_all_forces(state.positions, pulls_, state.forces);
  const double elastic = elastic_energy(parts_.body, state.positions, state.rotations, parts_.threads);
  state.energy_noise = 0;
  const double step = add_potential(state);
  double weight = 0, terms = std::abs(elastic) + std::abs(step);
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const double part = parts_.masses.mass[i] * parts_.model.gravity.dot(state.positions[i]);
    weight += part;
    terms += std::abs(part);
    if (held_[i] != 0) state.forces[i].setZero();
  }
  state.energy = elastic - weight + step;
  for (const ActivePull& pull : pulls_) state.energy += pull_energy(pull, state.positions);
  terms += std::abs(state.energy);
  state.energy_noise += 100 * std::numeric_limits<double>::epsilon() * terms;
  measure_pieces(state);
  state.residual = std::sqrt(dot(state.forces, state.forces));
}

void StaticSolver::assemble(const StaticState& state, Curvature curvature) {
  const ScopedStage stage(parts_.times, "simulate/assemble");
  if (parts_.params.rotation == RotationMethod::None) curvature = Curvature::None;
  find_stiffness_terms(parts_.body, state.positions, state.rotations, shares_, curvature, parts_.terms, parts_.threads);
  if (is_damped()) adjust_terms_to_damping(state, curvature);
  parts_.assembler().assemble(parts_.terms, node_terms_, parts_.matrix, parts_.threads);
  for (const ActivePull& pull : pulls_) add_pull_stiffness(pull, state.positions, 1.0, parts_.matrix);
  if (potential_ == nullptr || !potential_->has_frozen_damping()) return;
  const AlignedVector<double>& frozen = potential_->frozen_damping.values;
  for (std::size_t k = 0; k < frozen.size(); ++k) parts_.matrix.values[k] += frozen[k];
}

bool StaticSolver::has_rigid_parts() const {
  return stiffness_contrast_ >= kRigidContrast;
}

bool StaticSolver::is_damped() const {
  return potential_ != nullptr && !potential_->damping.empty();
}

/// Of the shares, only 1 is elastic; that of damping has slopes and curvature of its own.
void StaticSolver::adjust_terms_to_damping(const StaticState& state, Curvature curvature) {
  StiffnessTerms& terms = parts_.terms;
  const StrainDamping& damping = potential_->damping;
  const auto chunk = [&](std::int64_t begin, std::int64_t end) {
    double adjusted = 0;
    CurvatureBatch batch(curvature == Curvature::PositivePart);
    for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
      const double share = 1 - 1 / shares_[e];
      if (share == 0) continue;
      const ElasticLaw& law = parts_.body.laws[e];
      if (const double ratio = damping.slopes[e] / law.mu; ratio != terms.ratios[e]) {
        terms.ratios[e] += share * (ratio - terms.ratios[e]);
        ++adjusted;
      }
      if (terms.curvatures.empty()) continue;
      const Mat3 F =
          deformation_gradient(parts_.body.shapes[e].gradients, nodes_of(parts_.body.tets[e], state.positions));
      terms.curvatures[e] /= shares_[e];
      add_damping_curvature(law, damping, e, state.rotations[e].toRotationMatrix(), F, 1 / (law.mu * shares_[e]), batch,
                            terms.curvatures[e]);
    }
    batch.finish();
    return adjusted;
  };
  const double different = parts_.threads.sum_chunks(static_cast<std::int64_t>(shares_.size()), kElementGrain, chunk);
  terms.uniform_ratio = terms.uniform_ratio && different == 0;
}

SolveReport StaticSolver::solve_linear(const StaticState& state, std::span<const Vec3> right_side, double tolerance,
                                       int max_iterations, std::span<Vec3> change) {
  const ScopedStage stage(parts_.times, "simulate/solve");
  const double floor = (potential_ != nullptr ? kStepFloor : kStaticFloor) * least_round_off(state);
  const SolveReport report =
      parts_.multigrid.solve(parts_.matrix, right_side, change, tolerance, floor, max_iterations);
  linear_iterations_ += report.iterations;
  return report;
}

void StaticSolver::precondition(const StaticState& state) {
  assemble(state, Curvature::PositivePart);
  make_cycle();
}

/// Of the matrix that was assembled last, which must be definite.
void StaticSolver::make_cycle() {
  eliminate_held(parts_.matrix, held_, parts_.threads);
  const ScopedStage stage(parts_.times, "simulate/update");
  parts_.multigrid.update(parts_.matrix, held_);
  has_cycle_ = true;
}

bool StaticSolver::solve_direction(const StaticState& state, double tolerance, int max_iterations,
                                   std::vector<Vec3>& direction) {
  std::fill(direction.begin(), direction.end(), Vec3::Zero());
  const SolveReport report = solve_linear(state, state.forces, tolerance, max_iterations, direction);
  for (std::size_t i = 0; i < direction.size(); ++i)
    if (held_[i] != 0) direction[i].setZero();
  remove_rigid_motion(parts_.pieces, held_pieces_, parts_.masses.mass, state.positions, direction);
  // An unfinished solve is a direction, too, if it got nearer; one that met negative curvature may be far off.
  // So may one that ends at round-off: directions that grow without bound raise what counts as round-off with them.
  const bool nearer = report.status != SolveStatus::Breakdown && report.residual < kNearer;
  return nearer && is_positive(dot(direction, state.forces));
}

std::vector<Vec3> StaticSolver::forces_at(std::vector<Vec3> positions, std::vector<Quaternion> rotations) {
  std::vector<Vec3> forces(positions.size());
  find_rotations(parts_.body, parts_.params.rotation, positions, rotations, parts_.threads);
  find_stresses(parts_.body, positions, rotations, parts_.stresses, parts_.threads);
  parts_.gather_all_forces(positions, pulls_, forces);
  std::vector<Vec3> of_step(potential_ != nullptr ? forces.size() : 0);
  if (potential_ != nullptr) potential_->evaluate(parts_.body, positions, rotations, of_step, parts_.threads);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (potential_ != nullptr) forces[i] += of_step[i];
    if (held_[i] != 0) forces[i].setZero();
  }
  return forces;
}

/// Newton's direction where the rotation has no energy. Its tangent is neither symmetric nor that of the consistent
/// rotation, along whose direction the residual falls slowly (a twist took 1.5 to 2.5 times the iterations) or not at
/// all. Differences of the force multiply by the true one; the consistent one only preconditions.
bool StaticSolver::find_direction_without_energy(const StaticState& state, std::vector<Vec3>& direction) {
  precondition(state);
  double volume = 0;
  for (const ElementShape& shape : parts_.body.shapes) volume += shape.volume;
  const double size = std::cbrt(volume / static_cast<double>(parts_.body.shapes.size()));
  const auto zero_held = [&](std::span<Vec3> vectors) {
    for (std::size_t i = 0; i < vectors.size(); ++i)
      if (held_[i] != 0) vectors[i].setZero();
  };
  const auto apply = [&](std::span<const Vec3> v, std::span<Vec3> product) {
    double longest = 0;
    for (const Vec3& x : v) longest = std::max(longest, x.norm());
    const double step = longest > 0 ? kDifferenceStep * size / longest : 0;
    std::vector<Vec3> positions = state.positions;
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += step * v[i];
    const std::vector<Vec3> forces = forces_at(std::move(positions), state.rotations);
    for (std::size_t i = 0; i < product.size(); ++i) {
      product[i] = step > 0 ? Vec3((state.forces[i] - forces[i]) / step) : Vec3(Vec3::Zero());
      // What holds the rigid motions of statics is no force; the inertia of a step is, and is in the difference.
      if (potential_ == nullptr) product[i] += node_terms_[i] * v[i];
    }
    zero_held(product);
  };
  const auto precondition_vector = [&](std::span<const Vec3> r, std::span<Vec3> z) {
    std::fill(z.begin(), z.end(), Vec3::Zero());
    const ScopedStage stage(parts_.times, "simulate/solve");
    linear_iterations_ +=
        parts_.multigrid.solve(parts_.matrix, r, z, kInnerTolerance, 0.0, kIndefiniteIterations).iterations;
    zero_held(z);
  };
  const GmresReport report =
      solve_by_gmres(apply, precondition_vector, state.forces, kWorstLinearTolerance, kGmresIterations, direction);
  remove_rigid_motion(parts_.pieces, held_pieces_, parts_.masses.mass, state.positions, direction);
  return report.residual < kNearer;
}

/// Newton's direction by the exact tangent, if that is one of descent; else by the positive part of its curvature,
/// which also makes the cycle: it is near the tangent and always definite.
bool StaticSolver::find_direction(const StaticState& state, double tolerance, std::vector<Vec3>& direction) {
  if (!has_energy(parts_.params.rotation)) return find_direction_without_energy(state, direction);
  // Within a step of time a body does not go far, so that the cycle of a state before this one may do.
  const bool lags = has_cycle_ && potential_ != nullptr && stiffness_contrast_ <= kLaggingContrast;
  if (!lags) precondition(state);
  assemble(state, Curvature::Signed);
  eliminate_held(parts_.matrix, held_, parts_.threads);
  const int before = linear_iterations_;
  unstable_ =
      !solve_direction(state, tolerance, std::min(parts_.params.max_iterations, kIndefiniteIterations), direction);
  has_cycle_ = !unstable_ && linear_iterations_ - before <= kMostOfLagging;
  if (unstable_ && lags) return find_direction(state, tolerance, direction);
  return !unstable_ || find_stable_direction(state, tolerance, direction);
}

/// That by the positive part. Its cycle is made again, because a solve that meets negative curvature may have replaced
/// it by one of its own matrix.
bool StaticSolver::find_stable_direction(const StaticState& state, double tolerance, std::vector<Vec3>& direction) {
  unstable_ = true;
  precondition(state);
  return solve_direction(state, tolerance, parts_.params.max_iterations, direction);
}

/// The first iteration that moves held nodes is a full step: the body follows as a linear one would.
bool StaticSolver::move_held(StaticState& state, std::span<const Vec3> targets) {
  const std::size_t n = state.positions.size();
  std::vector<Vec3> moves(n, Vec3::Zero()), right_side(n), change(n, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i)
    if (held_[i] != 0) moves[i] = targets[i] - state.positions[i];
  if (!held_nodes_move(held_, state.positions, targets)) {
    const bool rounded = std::any_of(moves.begin(), moves.end(), [](const Vec3& move) { return !move.isZero(0); });
    for (std::size_t i = 0; i < n; ++i)
      if (held_[i] != 0) state.positions[i] = targets[i];
    if (rounded) evaluate(state);
    return std::isfinite(state.residual);
  }
  assemble(state, Curvature::PositivePart);
  multiply(parts_.matrix, moves, right_side, parts_.threads);
  make_cycle();
  for (std::size_t i = 0; i < n; ++i) {
    right_side[i] = state.forces[i] - right_side[i];
    if (held_[i] != 0) right_side[i].setZero();
  }
  ++iterations_;
  if (solve_linear(state, right_side, kWorstLinearTolerance, parts_.params.max_iterations, change).status ==
      SolveStatus::Breakdown)
    return false;
  for (std::size_t i = 0; i < n; ++i)
    state.positions[i] = held_[i] != 0 ? targets[i] : Vec3(state.positions[i] + change[i]);
  evaluate(state);
  return std::isfinite(state.residual);
}

SolveReport StaticSolver::solve(StaticState& state, std::span<const Vec3> targets, double tolerance,
                                int max_iterations) {
  SolveReport report;
  linear_iterations_ = 0;
  const auto finish = [&](SolveStatus status) {
    report.status = status;
    report.iterations = linear_iterations_;
    report.residual = imbalance(state);
    return report;
  };
  evaluate(state);
  if (!std::isfinite(state.residual) || !move_held(state, targets)) return finish(SolveStatus::Breakdown);
  std::vector<Vec3> direction(state.positions.size());
  double before = std::numeric_limits<double>::infinity();
  int stalls = 0;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    if (balances(state, tolerance)) return finish(SolveStatus::Converged);
    stalls = state.residual < 0.5 * before ? 0 : stalls + 1;
    if (balances(state, tolerance, 1) && (potential_ == nullptr || stalls > kStalls))
      return finish(SolveStatus::RoundOff);
    before = state.residual;
    ++iterations_;
    // Looser far from the solution, so that the iteration converges superlinearly but no solve is finer than it helps.
    const double relative = imbalance(state);
    const double linear =
        std::clamp(std::max(0.1 * relative, 0.3 * tolerance / relative), kBestLinearTolerance, kWorstLinearTolerance);
    const bool has_direction = find_direction(state, linear, direction);
    if (has_direction && is_negligible(direction, state.positions)) return finish(SolveStatus::RoundOff);
    if (!step_along(state, linear, has_direction, direction))
      return finish(balances(state, tolerance, 100) ? SolveStatus::RoundOff : SolveStatus::Breakdown);
  }
  return finish(balances(state, tolerance) ? SolveStatus::Converged : SolveStatus::MaxIterations);
}

}  // namespace softreel
