// Projective dynamics: S. Bouaziz, S. Martin, T. Liu, L. Kavan, M. Pauly, "Projective dynamics: fusing constraint
// projections for fast simulation", 2014; as a descent by T. Liu, S. Bouaziz, L. Kavan, "Quasi-Newton methods for
// real-time simulation of hyperelastic materials", 2017.
#include <stdexcept>

#include "tests/benchmark/rivals/rival.h"
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

class ProjectiveStepper : public Stepper {
 public:
  ProjectiveStepper(BodyModel model, const ProjectiveParams& params)
      : params_(params), rival_(std::move(model), Dilatation::Linear) {
    if (params.iterations < 1) throw std::runtime_error("make_projective_dynamics: iterations: 1 or more");
  }

  void step(double frame, double seconds) override {
    const StepConstraints constraints = rival_.constraints_at(frame);
    prepare(constraints, seconds);
    const std::vector<Vec3> inertial = rival_.inertial_positions(constraints.pinned, seconds);
    std::vector<Vec3> ends = inertial;
    find_rotations(rival_.body, RotationMethod::Consistent, rival_.positions, rival_.rotations, rival_.threads);
    start_rotations_ = rival_.rotations;
    for (int i = 0; i < params_.iterations && free_count_ > 0; ++i) {
      find_forces(ends, constraints, seconds);
      for (std::size_t k = 0; k < ends.size(); ++k)
        if (numbers_[k] >= 0)
          right_sides_.row(numbers_[k]) =
              forces_[k] + rival_.damped_mass(k, seconds) / (seconds * seconds) * (inertial[k] - ends[k]);
      const Eigen::MatrixX3d change = factor_->solve(right_sides_);
      for (std::size_t k = 0; k < ends.size(); ++k)
        if (numbers_[k] >= 0) ends[k] += change.row(numbers_[k]).transpose();
    }
    rival_.move_to(std::move(ends), seconds, "projective dynamics");
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
    right_sides_.resize(free_count_, 3);
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

  /// Forces of the local step: an element with the projections R and F - tr(R^T F - I) / 3 R has the stress
  /// 2 mu (F - R) + lambda tr(R^T F - I) R, which is the corotated material's. Damping as in core's iterated step.
  void find_forces(const std::vector<Vec3>& positions, const StepConstraints& constraints, double h) {
    const ElasticBody& body = rival_.body;
    find_rotations(body, RotationMethod::Consistent, positions, rival_.rotations, rival_.threads);
    stresses_.resize(body.tets.size());
    for (std::size_t e = 0; e < body.tets.size(); ++e) {
      const ElementShape& shape = body.shapes[e];
      const Mat3 F = deformation_gradient(shape.gradients, nodes_of(body.tets[e], positions));
      stresses_[e] = shape.volume * corotated_stress(body.laws[e], rival_.rotations[e].toRotationMatrix(), F);
      const double damping = rival_.damping_stiffness[e] / h;
      if (damping == 0) continue;
      const Mat3 before = deformation_gradient(shape.gradients, nodes_of(body.tets[e], rival_.positions));
      const Mat3 R = start_rotations_[e].toRotationMatrix();
      const Mat3 strain = R.transpose() * (F - before);
      stresses_[e] +=
          damping * shape.volume * R *
          (body.laws[e].mu * (strain + strain.transpose()) + body.laws[e].lambda * strain.trace() * Mat3::Identity());
    }
    forces_.resize(rival_.nodes());
    gather_forces(body, stresses_, forces_, rival_.threads);
    for (const ActivePull& pull : constraints.pulls) add_pull_forces(pull, positions, forces_);
  }

  ProjectiveParams params_;
  RivalBody rival_;
  GlobalKey key_;
  std::vector<Index> numbers_;  ///< per node: its row, -1 if it is held
  Index free_count_ = 0;
  std::unique_ptr<rivals::Factor> factor_;
  Eigen::MatrixX3d right_sides_;
  std::vector<Quaternion> start_rotations_;
  std::vector<Mat3> stresses_;
  std::vector<Vec3> forces_;
};

}  // namespace

std::unique_ptr<Stepper> make_projective_dynamics(BodyModel model, const ProjectiveParams& params) {
  return std::make_unique<ProjectiveStepper>(std::move(model), params);
}

}  // namespace softreel::bench
