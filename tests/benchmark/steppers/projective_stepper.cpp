// Projective dynamics: S. Bouaziz, S. Martin, T. Liu, L. Kavan, M. Pauly, "Projective dynamics: fusing constraint
// projections for fast simulation", 2014; as a descent by T. Liu, S. Bouaziz, L. Kavan, "Quasi-Newton methods for
// real-time simulation of hyperelastic materials", 2017.
#include <stdexcept>

#include "core/elasticity/element_rotation.h"
#include "tests/benchmark/rivals/rival.h"
#include "tests/benchmark/steppers/descent_memory.h"
#include "tests/benchmark/steppers/rival_body.h"
#include "tests/benchmark/steppers/stepper.h"

namespace softreel::bench {
namespace {

/// What the global matrix is made of; while it stays the same, so does the factor.
struct GlobalKey {
  double seconds = 0;
  std::vector<std::uint8_t> held;
  std::vector<double> spring_stiffness;
  bool operator==(const GlobalKey&) const = default;
};

/// Weights of the two local projections of an element, 1 / m^2 times m^3 Pa: V times 2 mu for strain and 3 lambda for
/// volume, whose distance to the projection is tr(R^T F - I) / sqrt(3).
double global_weight(const ElasticBody& body, std::size_t e) {
  return body.shapes[e].volume * (2 * body.laws[e].mu + 3 * body.laws[e].lambda);
}

/// Armijo's share of the descent that the first slope promises, and the shortest part of a direction.
constexpr double kArmijo = 1e-4, kShortest = 1e-3;

/// What one step is to minimise.
struct StepGoal {
  const StepConstraints& constraints;
  std::vector<Vec3> inertial;
  double seconds = 0;
};

struct Evaluation {
  double objective = 0;      ///< J
  Eigen::MatrixX3d descent;  ///< minus its gradient, N, one row per free node
};

class ProjectiveStepper : public Stepper {
 public:
  ProjectiveStepper(BodyModel model, const ProjectiveParams& params)
      : params_(params), rival_(std::move(model), Dilatation::Linear) {
    if (params.iterations < 1) throw std::runtime_error("make_projective_dynamics: iterations: 1 or more");
    if (params.memory < 0) throw std::runtime_error("make_projective_dynamics: memory: 0 or more");
  }

  void step(double frame, double seconds) override {
    const StepConstraints constraints = rival_.constraints_at(frame);
    prepare(constraints, seconds);
    const StepGoal goal{constraints, rival_.inertial_positions(constraints.pinned, seconds), seconds};
    find_rotations(rival_.body, RotationMethod::Consistent, rival_.positions, rival_.rotations, rival_.threads);
    start_rotations_ = rival_.rotations;
    rival_.move_to(free_count_ > 0 ? descend(goal) : goal.inertial, seconds, "projective dynamics");
  }
  std::span<const Vec3> positions() const override { return rival_.positions; }
  std::span<const Vec3> velocities() const override { return rival_.velocities; }

 private:
  /// Factors the matrix again if a node was pinned or let go, or a pull or the step's length changed.
  void prepare(const StepConstraints& constraints, double seconds) {
    GlobalKey key{seconds, constraints.pinned.held, {}};
    for (const ActivePull& pull : constraints.pulls) {
      if (pull.max_force > 0) throw std::runtime_error("projective dynamics: pulls with max_force are not built");
      for (const Spring& spring : pull.springs) key.spring_stiffness.push_back(spring.stiffness);
    }
    if (key == key_) return;
    numbers_.assign(rival_.nodes(), -1);
    free_count_ = 0;
    for (std::size_t i = 0; i < rival_.nodes(); ++i)
      if (key.held[i] == 0) numbers_[i] = free_count_++;
    if (free_count_ > 0) factor(constraints, seconds);
    key_ = std::move(key);
  }

  /// One scalar matrix for x, y and z: damped mass / h^2 on the diagonal and the projections' weights.
  void factor(const StepConstraints& constraints, double h) {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](Index i, Index j, double value) {
      const Index row = numbers_[static_cast<std::size_t>(i)], column = numbers_[static_cast<std::size_t>(j)];
      if (row >= 0 && column >= 0) entries.emplace_back(row, column, value);
    };
    for (std::size_t i = 0; i < rival_.nodes(); ++i)
      add(static_cast<Index>(i), static_cast<Index>(i), rival_.damped_mass(i, h) / (h * h));
    for (std::size_t e = 0; e < rival_.body.tets.size(); ++e) {
      const double weight = global_weight(rival_.body, e) * (1 + rival_.damping_stiffness[e] / h);
      const Gradients& b = rival_.body.shapes[e].gradients;
      const Tet& tet = rival_.body.tets[e];
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          add(tet[static_cast<std::size_t>(i)], tet[static_cast<std::size_t>(j)], weight * b.col(i).dot(b.col(j)));
    }
    for (const ActivePull& pull : constraints.pulls)
      for (const Spring& spring : pull.springs)
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = 0; j < 4; ++j)
            add(spring.nodes[i], spring.nodes[j], spring.stiffness * spring.weights[i] * spring.weights[j]);
    Eigen::SparseMatrix<double> matrix(free_count_, free_count_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    factor_ = rivals::make_cholmod_factor(matrix);
    if (!factor_) factor_ = rivals::make_eigen_factor(matrix);
  }

  /// From inertia alone, so many local and global steps.
  std::vector<Vec3> descend(const StepGoal& goal) {
    DescentMemory memory(static_cast<std::size_t>(params_.memory));
    std::vector<Vec3> ends = goal.inertial;
    Evaluation now = evaluate(ends, goal);
    for (int i = 0; i < params_.iterations; ++i) {
      const Eigen::MatrixX3d direction =
          memory.direction(now.descent, [&](const Eigen::MatrixX3d& v) { return factor_->solve(v); });
      if (params_.memory == 0) {
        ends = moved(ends, direction, 1);
        if (i + 1 < params_.iterations) now = evaluate(ends, goal);
        continue;
      }
      double length = 1;
      Evaluation next = evaluate(moved(ends, direction, length), goal);
      const double slope = now.descent.cwiseProduct(direction).sum();
      while (!(next.objective <= now.objective - kArmijo * length * slope) && length > kShortest) {
        length /= 2;
        next = evaluate(moved(ends, direction, length), goal);
      }
      if (!(next.objective < now.objective)) break;  // round-off: nothing is left to gain
      ends = moved(ends, direction, length);
      memory.remember(length * direction, now.descent - next.descent);
      now = std::move(next);
    }
    return ends;
  }

  std::vector<Vec3> moved(std::vector<Vec3> ends, const Eigen::MatrixX3d& direction, double length) const {
    for (std::size_t k = 0; k < ends.size(); ++k)
      if (numbers_[k] >= 0) ends[k] += length * direction.row(numbers_[k]).transpose();
    return ends;
  }

  /// What implicit Euler minimises, and the local step's forces, which are its descent.
  Evaluation evaluate(const std::vector<Vec3>& ends, const StepGoal& goal) {
    Evaluation result{find_stresses(ends, goal.seconds), Eigen::MatrixX3d(free_count_, 3)};
    forces_.resize(rival_.nodes());
    gather_forces(rival_.body, stresses_, forces_, rival_.threads);
    for (const ActivePull& pull : goal.constraints.pulls) {
      add_pull_forces(pull, ends, forces_);
      result.objective += pull_energy(pull, ends);
    }
    for (std::size_t k = 0; k < ends.size(); ++k) {
      if (numbers_[k] < 0) continue;
      const double inertia = rival_.damped_mass(k, goal.seconds) / (goal.seconds * goal.seconds);
      const Vec3 way = goal.inertial[k] - ends[k];
      result.objective += 0.5 * inertia * way.squaredNorm();
      result.descent.row(numbers_[k]) = forces_[k] + inertia * way;
    }
    return result;
  }

  /// Weighted stresses, and their energy. With the projections R and F - tr(R^T F - I) / 3 R an element has the stress
  /// 2 mu (F - R) + lambda tr(R^T F - I) R, which is the corotated material's. Damping as in core's iterated step.
  double find_stresses(const std::vector<Vec3>& positions, double h) {
    const ElasticBody& body = rival_.body;
    find_rotations(body, RotationMethod::Consistent, positions, rival_.rotations, rival_.threads);
    stresses_.resize(body.tets.size());
    double energy = 0;
    for (std::size_t e = 0; e < body.tets.size(); ++e) {
      const ElementShape& shape = body.shapes[e];
      const Mat3 F = deformation_gradient(shape.gradients, nodes_of(body.tets[e], positions));
      const Mat3 R = rival_.rotations[e].toRotationMatrix();
      energy += add_stress(e, shape.volume, R, corotated_strain(R, F), stresses_[e].setZero());
      const double damping = rival_.damping_stiffness[e] / h;
      if (damping == 0) continue;
      const Mat3 start = deformation_gradient(shape.gradients, nodes_of(body.tets[e], rival_.positions));
      const Mat3 before = corotated_strain(start_rotations_[e].toRotationMatrix(), start) + Mat3::Identity();
      energy += add_damping(e, damping * shape.volume, R, F, before, stresses_[e]);
    }
    return energy;
  }

  /// Adds weight R (2 mu strain + lambda tr(strain) I); returns its energy.
  double add_stress(std::size_t e, double weight, const Mat3& R, const Mat3& strain, Mat3& stress) const {
    const double mu = weight * rival_.body.laws[e].mu, pressure = weight * rival_.body.laws[e].lambda * strain.trace();
    stress += R * (2 * mu * strain + pressure * Mat3::Identity());
    return mu * strain.squaredNorm() + 0.5 * pressure * strain.trace();
  }

  /// The same for mu |F - Q before|^2 + lambda (tr(R^T F) - tr before)^2 / 2, with the projection Q on the turned
  /// copies of the stretch at the start.
  double add_damping(std::size_t e, double weight, const Mat3& R, const Mat3& F, const Mat3& before,
                     Mat3& stress) const {
    const Mat3 Q = find_rotation(F * before, Quaternion(R)).toRotationMatrix(), away = F - Q * before;
    const double mu = weight * rival_.body.laws[e].mu, growth = (R.transpose() * F).trace() - before.trace();
    const double pressure = weight * rival_.body.laws[e].lambda * growth;
    stress += 2 * mu * away + pressure * R;
    return mu * away.squaredNorm() + 0.5 * pressure * growth;
  }

  ProjectiveParams params_;
  RivalBody rival_;
  GlobalKey key_;
  std::vector<Index> numbers_;  ///< per node: its row, -1 if it is held
  Index free_count_ = 0;
  std::unique_ptr<rivals::Factor> factor_;
  std::vector<Quaternion> start_rotations_;
  std::vector<Mat3> stresses_;
  std::vector<Vec3> forces_;
};

}  // namespace

std::unique_ptr<Stepper> make_projective_dynamics(BodyModel model, const ProjectiveParams& params) {
  return std::make_unique<ProjectiveStepper>(std::move(model), params);
}

}  // namespace softreel::bench
