// softreel's implicit Euler step (core/dynamics/step_system.cpp) with the linear system solved by other people's
// libraries.
//
// (M + h Ma + sum h (h + b) K_e + h^2 G) d = h f - (h Ma + h (h + b) K + h^2 G) v', d the change of velocity from v',
// which is the velocity at the start or, of held nodes, that of their way; G: core/elasticity/tension.h. Held nodes are
// taken out of the system.
#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "core/elasticity/assembly.h"
#include "core/elasticity/step_terms.h"
#include "core/elasticity/tension.h"
#include "core/elasticity/thickness.h"
#include "tests/benchmark/rivals/rival.h"
#include "tests/benchmark/steppers/rival_body.h"
#include "tests/benchmark/steppers/stepper.h"

namespace softreel::bench {
namespace {

using rivals::Rival;
using rivals::ScalarSystem;

/// Of the harmless tension that softreel leaves out of an Euler step's matrix (core/dynamics/step_system.cpp).
constexpr double kExplicitShare = 0.5;

const char* name_of(DirectSolver solver) {
  switch (solver) {
    case DirectSolver::EigenLdlt:
      return "Eigen LDLT";
    case DirectSolver::Cholmod:
      return "CHOLMOD";
    case DirectSolver::EigenCgDiagonal:
      return "Eigen CG with Jacobi";
    case DirectSolver::EigenCgIncompleteCholesky:
      break;
  }
  return "Eigen CG with incomplete Cholesky";
}

std::unique_ptr<Rival> make_solver(DirectSolver solver, const ScalarSystem& system) {
  switch (solver) {
    case DirectSolver::EigenLdlt:
      return rivals::make_eigen_ldlt(system);
    case DirectSolver::Cholmod:
      return rivals::make_cholmod(system, 1);
    case DirectSolver::EigenCgDiagonal:
      return rivals::make_eigen_cg_diagonal(system);
    case DirectSolver::EigenCgIncompleteCholesky:
      break;
  }
  return rivals::make_eigen_cg_ic(system);
}

bool iterates(DirectSolver solver) {
  return solver == DirectSolver::EigenCgIncompleteCholesky || solver == DirectSolver::EigenCgDiagonal;
}

AlignedVector<double> tension_limits(const RivalBody& rival, const BlockPattern& pattern) {
  std::vector<double> moduli;
  for (const ElementMaterial& material : rival.model.materials) moduli.push_back(material.youngs_modulus);
  return find_tension_limits(rival.body, find_thickness(rival.model.mesh, pattern, moduli), rival.model.materials,
                             kExplicitShare);
}

/// What the solutions of past steps say of the next one.
class ChangeHistory {
 public:
  /// change: of the velocities of `nodes` in a step of `seconds`; that of all other nodes is 0.
  void remember(const std::vector<Index>& nodes, std::size_t all_nodes, const Eigen::VectorXd& change, double seconds) {
    before_ = std::move(last_);
    last_.assign(all_nodes, Vec3::Zero());
    for (std::size_t k = 0; k < nodes.size(); ++k)
      last_[static_cast<std::size_t>(nodes[k])] = change.segment<3>(3 * static_cast<Eigen::Index>(k)) / seconds;
  }

  /// The sum of multiples of the last acceleration and of its last change that is nearest to the solution in the energy
  /// norm: never farther than zero is. Zero where nothing is known.
  Eigen::VectorXd guess(const ScalarSystem& system) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(system.load.size());
    if (last_.empty()) return sum;
    const Eigen::VectorXd first = of_system(last_, system);
    const Eigen::VectorXd first_product = system.matrix * first;
    const double first_energy = first.dot(first_product);
    if (!(first_energy > kLeastEnergy)) return sum;
    sum = first.dot(system.load) / first_energy * first;
    if (before_.empty()) return sum;
    Eigen::VectorXd second = first - of_system(before_, system);
    second -= second.dot(first_product) / first_energy * first;
    const Eigen::VectorXd second_product = system.matrix * second;
    const double energy = second.dot(second_product);
    // What is left of a change along `first` is rounding and says nothing.
    if (energy > std::max(kLeastEnergy, kRounding * first_energy)) sum += second.dot(system.load) / energy * second;
    return sum;
  }

 private:
  static constexpr double kLeastEnergy = std::numeric_limits<double>::min(), kRounding = 1e-24;

  static Eigen::VectorXd of_system(const std::vector<Vec3>& of_nodes, const ScalarSystem& system) {
    Eigen::VectorXd entries(system.load.size());
    for (std::size_t k = 0; k < system.mesh_nodes.size(); ++k)
      entries.segment<3>(3 * static_cast<Eigen::Index>(k)) = of_nodes[static_cast<std::size_t>(system.mesh_nodes[k])];
    return entries;
  }

  std::vector<Vec3> last_, before_;  ///< accelerations per node, m/s^2; empty: no such step yet
};

class EulerStepper : public DirectStepper {
 public:
  EulerStepper(BodyModel model, const SolverParams& params, DirectSolver solver, FirstGuess guess)
      : params_(params),
        solver_kind_(solver),
        guesses_(guess == FirstGuess::Extrapolated && iterates(solver)),
        rival_(std::move(model), params.dilatation),
        system_{{stiffness_pattern(rival_.model.mesh.tets, static_cast<Index>(rival_.nodes())), {}}, {}, {}},
        assembler_(rival_.model.mesh.tets, system_.matrix.pattern),
        tension_limits_(tension_limits(rival_, system_.matrix.pattern)) {
    if (params.integrator != Integrator::Euler || linearization(params) != Linearize::Start)
      throw std::runtime_error("make_direct: only implicit Euler with one linearisation at the step's start");
  }

  void step(double frame, double seconds) override {
    const StepConstraints constraints = rival_.constraints_at(frame);
    std::vector<Vec3> ends(rival_.nodes()), base = rival_.velocities;
    for (std::size_t i = 0; i < ends.size(); ++i)
      if (constraints.pinned.held[i] != 0) base[i] = (constraints.pinned.targets[i] - rival_.positions[i]) / seconds;
    find_rotations(rival_.body, params_.rotation, rival_.positions, rival_.rotations, rival_.threads);
    assemble(constraints, seconds);
    find_right_side(constraints, base, seconds);
    solve(constraints.pinned);
    if (guesses_) history_.remember(scalar_.mesh_nodes, rival_.nodes(), change_, seconds);
    for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = rival_.positions[i] + seconds * base[i];
    for (std::size_t k = 0; k < scalar_.mesh_nodes.size(); ++k)
      ends[static_cast<std::size_t>(scalar_.mesh_nodes[k])] +=
          seconds * change_.segment<3>(3 * static_cast<Eigen::Index>(k));
    for (std::size_t i = 0; i < ends.size(); ++i)
      if (constraints.pinned.held[i] != 0) ends[i] = constraints.pinned.targets[i];
    rival_.move_to(std::move(ends), seconds, name_of(solver_kind_));
  }
  std::span<const Vec3> positions() const override { return rival_.positions; }
  std::span<const Vec3> velocities() const override { return rival_.velocities; }
  long iterations() const override { return iterations_; }

 private:
  StepSource source(std::span<const Vec3> base, double h) const {
    return {rival_.positions, base, rival_.rotations, {h, h}, rival_.damping_stiffness, {}, -1, tension_limits_};
  }

  void assemble(const StepConstraints& constraints, double h) {
    std::vector<double> shares(rival_.body.tets.size()), node_terms(rival_.nodes());
    for (std::size_t e = 0; e < shares.size(); ++e) shares[e] = h * (h + rival_.damping_stiffness[e]);
    for (std::size_t i = 0; i < node_terms.size(); ++i) node_terms[i] = rival_.damped_mass(i, h);
    find_stiffness_terms(rival_.body, rival_.positions, rival_.rotations, shares, Curvature::None, terms_,
                         rival_.threads);
    terms_.curvatures = find_tension_curvatures(rival_.body, source({}, h), rival_.threads);
    assembler_.assemble(terms_, node_terms, system_.matrix, rival_.threads);
    for (const ActivePull& pull : constraints.pulls) add_pull_stiffness(pull, rival_.positions, h * h, system_.matrix);
  }

  /// Forces at the start, and what damping, stiffness and pulls take from `base`.
  void find_right_side(const StepConstraints& constraints, const std::vector<Vec3>& base, double h) {
    system_.load.resize(rival_.nodes());
    find_step_terms(rival_.body, source(base, h), step_terms_, rival_.threads);
    gather_step_forces(rival_.body, step_terms_, system_.load, rival_.threads);
    for (std::size_t i = 0; i < rival_.nodes(); ++i)
      system_.load[i] += h * (rival_.masses.mass[i] * rival_.model.gravity - rival_.masses.damping[i] * base[i]);
    for (const ActivePull& pull : constraints.pulls) add_pull(pull, base, h);
  }

  /// h (force - h stiffness * base), the force being that at the start.
  void add_pull(const ActivePull& pull, const std::vector<Vec3>& base, double h) {
    std::vector<Vec3> forces(rival_.nodes(), Vec3::Zero());
    add_pull_forces(pull, rival_.positions, forces);
    for (std::size_t i = 0; i < forces.size(); ++i) system_.load[i] += h * forces[i];
    const double factor = h * h * pull_factor(pull, rival_.positions);
    for (const Spring& spring : pull.springs) {
      Vec3 velocity = Vec3::Zero();
      for (std::size_t k = 0; k < 4; ++k)
        velocity += spring.weights[k] * base[static_cast<std::size_t>(spring.nodes[k])];
      for (std::size_t k = 0; k < 4; ++k)
        system_.load[static_cast<std::size_t>(spring.nodes[k])] -=
            factor * spring.stiffness * spring.weights[k] * velocity;
    }
  }

  /// Fills change_. The order of elimination is kept while the same nodes are held.
  void solve(const PinnedNodes& pinned) {
    if (!solver_ || pinned.held != system_.pinned) {
      solver_ = nullptr;
      system_.pinned = pinned.held;
      scalar_ = rivals::make_scalar_system(system_, rival_.body.rest_positions);
      if (!scalar_.mesh_nodes.empty()) solver_ = make_solver(solver_kind_, scalar_);
    } else {
      rivals::take_values(system_, scalar_);
    }
    change_ = Eigen::VectorXd::Zero(scalar_.load.size());
    if (scalar_.mesh_nodes.empty() || scalar_.load.isZero(0)) return;
    solver_->update();
    iterations_ += guesses_ ? solver_->solve_from(history_.guess(scalar_), params_.tolerance, change_)
                            : solver_->solve(params_.tolerance, change_);
  }

  SolverParams params_;
  DirectSolver solver_kind_;
  bool guesses_;
  RivalBody rival_;
  benchmark_support::LinearSystem system_;
  StiffnessAssembler assembler_;
  AlignedVector<double> tension_limits_;
  StiffnessTerms terms_;
  StepTerms step_terms_;
  ScalarSystem scalar_;
  std::unique_ptr<Rival> solver_;
  Eigen::VectorXd change_;
  ChangeHistory history_;
  long iterations_ = 0;
};

}  // namespace

std::unique_ptr<DirectStepper> make_direct(BodyModel model, const SolverParams& params, DirectSolver solver,
                                           FirstGuess guess) {
  if (solver == DirectSolver::Cholmod && !rivals::has_cholmod()) return nullptr;
  return std::make_unique<EulerStepper>(std::move(model), params, solver, guess);
}

}  // namespace softreel::bench
