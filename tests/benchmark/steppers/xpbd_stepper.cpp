// Extended position-based dynamics: M. Macklin, M. Mueller, N. Chentanez, "XPBD: position-based simulation of compliant
// constrained dynamics", 2016, with the damping of its eq. (26); in small steps: M. Macklin, K. Storey, M. Lu,
// P. Terdiman, N. Chentanez, S. Jeschke, M. Mueller, "Small steps in physics simulation", 2019.
//
// A tetrahedron has the constraints D = |F - R| with compliance 1 / (2 mu V) and H = tr(R^T F) - 3 with 1 / (lambda V),
// R the polar rotation: their energy, C^2 / (2 compliance), is that of the corotated linear material. R drops out of
// the derivatives, being stationary: dD = n : dF with n = (F - R) / D, dH = R : dF. The two are solved together, as
// M. Macklin and M. Mueller, "A constraint-based formulation of stable neo-Hookean materials", 2021, advise.
#include <algorithm>
#include <stdexcept>

#include <Eigen/LU>

#include "core/elasticity/element_rotation.h"
#include "tests/benchmark/steppers/rival_body.h"
#include "tests/benchmark/steppers/stepper.h"

namespace softreel::bench {
namespace {

using Mat2 = Eigen::Matrix2d;

/// Below this D, which is a strain, there is no direction n and nothing to correct.
constexpr double kNoStrain = 1e-14;

/// Elements without a common node, whose rotations the vector kernel finds at once: as good as one after the other.
struct DisjointElements {
  std::array<Index, kRotationLanes> elements{};
  std::size_t count = 0;
};

/// All elements, nearly in their order: each goes into the first group with room that has none of its nodes.
std::vector<DisjointElements> group_elements(const std::vector<Tet>& tets, std::size_t nodes) {
  std::vector<DisjointElements> groups;
  std::vector<std::vector<std::size_t>> groups_of_node(nodes);  // ascending
  std::vector<std::size_t> open;
  for (std::size_t e = 0; e < tets.size(); ++e) {
    const auto fits = [&](std::size_t group) {
      return std::none_of(tets[e].begin(), tets[e].end(), [&](Index node) {
        const std::vector<std::size_t>& taken = groups_of_node[static_cast<std::size_t>(node)];
        return std::find(taken.rbegin(), taken.rend(), group) != taken.rend();
      });
    };
    auto at = std::find_if(open.begin(), open.end(), fits);
    if (at == open.end()) {
      at = open.insert(open.end(), groups.size());
      groups.emplace_back();
    }
    DisjointElements& group = groups[*at];
    group.elements[group.count++] = static_cast<Index>(e);
    for (const Index node : tets[e]) groups_of_node[static_cast<std::size_t>(node)].push_back(*at);
    if (group.count == group.elements.size()) open.erase(at);
  }
  return groups;
}

/// Multipliers of D and H, and of springs, within one substep.
struct Multipliers {
  std::vector<Vec2> elements;
  std::vector<Vec3> springs;
};

class XpbdStepper : public Stepper {
 public:
  XpbdStepper(BodyModel model, const XpbdParams& params)
      : params_(params),
        rival_(std::move(model), Dilatation::Linear),
        groups_(group_elements(rival_.body.tets, rival_.nodes())) {
    if (params.substeps < 1 || params.iterations < 1)
      throw std::runtime_error("make_xpbd: substeps and iterations: 1 or more");
  }

  void step(double frame, double seconds) override {
    const StepConstraints constraints = rival_.constraints_at(frame);
    for (const ActivePull& pull : constraints.pulls)
      if (pull.max_force > 0) throw std::runtime_error("XPBD: pulls with max_force are not built");
    const std::vector<Vec3> starts = rival_.positions;
    PinnedNodes pinned = constraints.pinned;
    for (int k = 1; k <= params_.substeps; ++k) {
      const double part = static_cast<double>(k) / params_.substeps;
      for (std::size_t i = 0; i < starts.size(); ++i)
        if (pinned.held[i] != 0)
          pinned.targets[i] = k == params_.substeps
                                  ? constraints.pinned.targets[i]
                                  : Vec3(starts[i] + part * (constraints.pinned.targets[i] - starts[i]));
      substep(pinned, constraints.pulls, seconds / params_.substeps);
    }
  }
  std::span<const Vec3> positions() const override { return rival_.positions; }
  std::span<const Vec3> velocities() const override { return rival_.velocities; }

 private:
  void substep(const PinnedNodes& pinned, const std::vector<ActivePull>& pulls, double h) {
    inverse_masses_.resize(rival_.nodes());
    for (std::size_t i = 0; i < inverse_masses_.size(); ++i)
      inverse_masses_[i] = pinned.held[i] != 0 ? 0.0 : 1 / rival_.damped_mass(i, h);
    std::vector<Vec3> ends = rival_.inertial_positions(pinned, h);
    multipliers_.elements.assign(rival_.body.tets.size(), Vec2::Zero());
    std::size_t springs = 0;
    for (const ActivePull& pull : pulls) springs += pull.springs.size();
    multipliers_.springs.assign(springs, Vec3::Zero());
    for (int i = 0; i < params_.iterations; ++i) {
      for (const DisjointElements& group : groups_) project_group(group, h, ends);
      std::size_t s = 0;
      for (const ActivePull& pull : pulls)
        for (const Spring& spring : pull.springs) project_spring(spring, h, multipliers_.springs[s++], ends);
    }
    rival_.move_to(std::move(ends), h, "XPBD");
  }

  void project_group(const DisjointElements& group, double h, std::vector<Vec3>& ends) {
    MatrixLanes matrices;
    QuaternionLanes lanes;
    std::array<Mat3, kRotationLanes> F;
    for (std::size_t lane = 0; lane < kRotationLanes; ++lane) {
      const auto e = static_cast<std::size_t>(group.elements[std::min(lane, group.count - 1)]);
      F[lane] = deformation_gradient(rival_.body.shapes[e].gradients, nodes_of(rival_.body.tets[e], ends));
      const Quaternion& guess = rival_.rotations[e];
      const std::array<double, 4> entries{guess.w(), guess.x(), guess.y(), guess.z()};
      for (std::size_t k = 0; k < 4; ++k) lanes.entries[k][lane] = entries[k];
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) matrices.entries[3 * r + c][lane] = F[lane](r, c);
    }
    find_rotations(matrices, lanes);
    for (std::size_t lane = 0; lane < group.count; ++lane) {
      const auto e = static_cast<std::size_t>(group.elements[lane]);
      const auto& q = lanes.entries;
      rival_.rotations[e] = Quaternion(q[0][lane], q[1][lane], q[2][lane], q[3][lane]);
      project_element(e, F[lane], h, ends);
    }
  }

  void project_element(std::size_t e, const Mat3& F, double h, std::vector<Vec3>& ends) {
    const ElasticBody& body = rival_.body;
    const Tet& tet = body.tets[e];
    const Gradients& b = body.shapes[e].gradients;
    const Mat3 R = rival_.rotations[e].toRotationMatrix();
    const double strain = (F - R).norm();
    if (strain < kNoStrain) return;
    const Mat3 n = (F - R) / strain;

    const Gradients strain_gradients = n * b, volume_gradients = R * b;
    Mat2 A = Mat2::Zero();
    for (int k = 0; k < 4; ++k) {
      const double w = inverse_masses_[static_cast<std::size_t>(tet[static_cast<std::size_t>(k)])];
      A(0, 0) += w * strain_gradients.col(k).squaredNorm();
      A(0, 1) += w * strain_gradients.col(k).dot(volume_gradients.col(k));
      A(1, 1) += w * volume_gradients.col(k).squaredNorm();
    }
    A(1, 0) = A(0, 1);

    // In units of stiffness instead of compliance, lest lambda = 0 divides: with k = 1 / compliance the multiplier of
    // (A (1 + gamma) + 1 / (k h^2)) change = -(C + multiplier / (k h^2) + gamma dC) is found from k h^2 times that.
    const Vec2 stiffness = h * h * body.shapes[e].volume * Vec2(2 * body.laws[e].mu, body.laws[e].lambda);
    Vec2 C(strain, R.cwiseProduct(F).sum() - 3);
    const double gamma = rival_.damping_stiffness[e] / h;
    if (gamma > 0) {
      const Mat3 moved = F - deformation_gradient(b, nodes_of(tet, rival_.positions));
      C += gamma * Vec2(n.cwiseProduct(moved).sum(), R.cwiseProduct(moved).sum());
    }
    Vec2& multiplier = multipliers_.elements[e];
    const Mat2 system = (1 + gamma) * stiffness.asDiagonal() * A + Mat2::Identity();
    const Vec2 change = -(system.inverse() * (stiffness.cwiseProduct(C) + multiplier));
    multiplier += change;
    for (int k = 0; k < 4; ++k) {
      const auto node = static_cast<std::size_t>(tet[static_cast<std::size_t>(k)]);
      ends[node] += inverse_masses_[node] * (change[0] * strain_gradients.col(k) + change[1] * volume_gradients.col(k));
    }
  }

  void project_spring(const Spring& spring, double h, Vec3& multiplier, std::vector<Vec3>& ends) const {
    Vec3 C = spring.offset - spring.target;
    double A = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = static_cast<std::size_t>(spring.nodes[k]);
      C += spring.weights[k] * ends[node];
      A += inverse_masses_[node] * spring.weights[k] * spring.weights[k];
    }
    const double stiffness = h * h * spring.stiffness;
    const Vec3 change = -(stiffness * C + multiplier) / (stiffness * A + 1);
    multiplier += change;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = static_cast<std::size_t>(spring.nodes[k]);
      ends[node] += inverse_masses_[node] * spring.weights[k] * change;
    }
  }

  XpbdParams params_;
  RivalBody rival_;
  std::vector<DisjointElements> groups_;
  std::vector<double> inverse_masses_;  ///< of the damped masses; 0 where held
  Multipliers multipliers_;
};

}  // namespace

std::unique_ptr<Stepper> make_xpbd(BodyModel model, const XpbdParams& params) {
  return std::make_unique<XpbdStepper>(std::move(model), params);
}

}  // namespace softreel::bench
