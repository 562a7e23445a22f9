#include "core/constraints/pulls.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/constraints/targets.h"
#include "core/elasticity/elastic_body.h"

namespace softreel {
namespace {

/// Of an edge: as in skinning, a point whose weights give another place by more than that was not embedded where it is.
constexpr double kApart = 1e-6;

/// A spring's stiffness on a node grows with the square of its weight: of slivers, offsets that do not turn are better.
constexpr double kMostWeight = 8;

/// From the spring's point to its target.
Vec3 stretch(const Spring& spring, std::span<const Vec3> positions) {
  Vec3 point = spring.offset;
  for (std::size_t k = 0; k < spring.count; ++k)
    point += spring.weights[k] * positions[static_cast<std::size_t>(spring.nodes[k])];
  return spring.target - point;
}

/// Sum of k |d|^2 / 2 without the limit.
double unlimited_energy(const ActivePull& pull, std::span<const Vec3> positions) {
  double energy = 0;
  for (const Spring& spring : pull.springs) energy += 0.5 * spring.stiffness * stretch(spring, positions).squaredNorm();
  return energy;
}

/// The part of a rest point that the weights of its element do not give.
Vec3 offset_of(const Vec3& rest_point, const Tet& tet, const std::array<double, 4>& weights, const TetMesh& mesh) {
  Vec3 offset = rest_point;
  for (std::size_t k = 0; k < 4; ++k) offset -= weights[k] * mesh.nodes[static_cast<std::size_t>(tet[k])];
  return offset;
}

/// Where the bounded weights of the embedding give another point, what they leave out is carried on from its element:
/// an offset that did not turn with it would resist rigid rotation.
std::array<double, 4> spring_weights(const Vec3& rest_point, const Tet& tet, const std::array<double, 4>& weights,
                                     const TetMesh& mesh) {
  const Vec3 apart = offset_of(rest_point, tet, weights, mesh);
  const TetNodes x = nodes_of(tet, mesh.nodes);
  if (!(apart.squaredNorm() > kApart * kApart * (x[1] - x[0]).squaredNorm())) return weights;
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = x[static_cast<std::size_t>(k) + 1] - x[0];
  const Vec3 more = edges.inverse() * apart;
  const std::array<double, 4> whole{weights[0] - more.sum(), weights[1] + more[0], weights[2] + more[1],
                                    weights[3] + more[2]};
  const bool is_bounded = std::all_of(whole.begin(), whole.end(), [](double w) { return std::abs(w) <= kMostWeight; });
  return is_bounded ? whole : weights;
}

Spring make_spring(const Vec3& rest_point, const Tet& tet, const std::array<double, 4>& bounded, const TetMesh& mesh) {
  Spring spring;
  const std::array<double, 4> weights = spring_weights(rest_point, tet, bounded, mesh);
  std::copy(tet.begin(), tet.end(), spring.nodes.begin());
  std::copy(weights.begin(), weights.end(), spring.weights.begin());
  spring.offset = offset_of(rest_point, tet, weights, mesh);
  return spring;
}

}  // namespace

std::vector<Vec3> pull_targets(const Pull& pull, const std::vector<Vec3>& surface_points, double frame,
                               const Grab& grab) {
  std::vector<Vec3> rest;
  rest.reserve(pull.points.size());
  for (const Index point : pull.points) rest.push_back(surface_points[static_cast<std::size_t>(point)]);
  return guided_points({pull.track, pull.follow, pull.ties}, rest, frame, grab);
}

std::vector<ActivePull> active_pulls(const std::vector<Pull>& pulls, const std::vector<Vec3>& surface_points,
                                     const Embedding& embedding, const TetMesh& mesh, double frame,
                                     std::span<const Grab> grabs) {
  const Grab nothing;
  std::vector<ActivePull> active;
  for (std::size_t p = 0; p < pulls.size(); ++p) {
    const Pull& pull = pulls[p];
    const Index range = pulling_range(pull, frame);
    const Grab& grab = pull.grab && p < grabs.size() ? grabs[p] : nothing;
    if (range < 0 || (pull.grab && !grab.holds())) continue;
    const double stiffness = pull.stiffness.at(frame);
    const std::vector<Vec3> targets = pull_targets(pull, surface_points, frame, grab);
    ActivePull result{{}, 0, pull.max_force};
    for (std::size_t k = 0; k < pull.points.size(); ++k) {
      const auto point = static_cast<std::size_t>(pull.points[k]);
      Spring spring = make_spring(surface_points[point], mesh.tets[static_cast<std::size_t>(embedding.elements[point])],
                                  embedding.weights[point], mesh);
      spring.target = targets[k];
      spring.stiffness = stiffness * pull.weights[k];
      result.stiffness += spring.stiffness;
      result.springs.push_back(spring);
    }
    active.push_back(std::move(result));
  }
  return active;
}

void update_grabs(const std::vector<Pull>& pulls, const std::vector<Vec3>& surface_points, const Embedding& embedding,
                  const TetMesh& mesh, std::span<const Vec3> positions, double frame, std::span<Grab> grabs) {
  for (std::size_t p = 0; p < grabs.size(); ++p) {
    if (!pulls[p].grab) continue;
    update_grab(grabs[p], pulling_range(pulls[p], frame), frame, [&] {
      std::vector<Vec3> grabbed;
      for (const Index index : pulls[p].points) {
        const auto point = static_cast<std::size_t>(index);
        const Spring spring =
            make_spring(surface_points[point], mesh.tets[static_cast<std::size_t>(embedding.elements[point])],
                        embedding.weights[point], mesh);
        grabbed.push_back(-stretch(spring, positions));  // from a target at the origin
      }
      return grabbed;
    });
  }
}

double pull_factor(const ActivePull& pull, std::span<const Vec3> positions) {
  if (pull.max_force <= 0) return 1;
  const double force = std::sqrt(2 * pull.stiffness * unlimited_energy(pull, positions));
  return force > pull.max_force ? pull.max_force / force : 1.0;
}

ActivePull softened(ActivePull pull, double factor) {
  for (Spring& spring : pull.springs) spring.stiffness *= factor;
  pull.stiffness *= factor;
  pull.max_force = 0;
  return pull;
}

double pull_energy(const ActivePull& pull, std::span<const Vec3> positions) {
  const double energy = unlimited_energy(pull, positions);
  const double factor = pull_factor(pull, positions);
  if (factor == 1) return energy;
  const double force = pull.max_force / factor;
  return pull.max_force * (force - 0.5 * pull.max_force) / pull.stiffness;
}

void add_pull_forces(const ActivePull& pull, std::span<const Vec3> positions, std::span<Vec3> forces, double scale) {
  const double factor = scale * pull_factor(pull, positions);
  for (const Spring& spring : pull.springs) {
    const Vec3 force = factor * spring.stiffness * stretch(spring, positions);
    for (std::size_t k = 0; k < spring.count; ++k)
      forces[static_cast<std::size_t>(spring.nodes[k])] += spring.weights[k] * force;
  }
}

void add_pull_stiffness(const ActivePull& pull, std::span<const Vec3> positions, double scale, BlockMatrixd& matrix) {
  const double factor = scale * pull_factor(pull, positions);
  for (const Spring& spring : pull.springs)
    for (std::size_t i = 0; i < spring.count; ++i)
      for (std::size_t j = 0; j < spring.count; ++j) {
        double* block = matrix.block(matrix.pattern.find(spring.nodes[i], spring.nodes[j]));
        const double value = factor * spring.stiffness * spring.weights[i] * spring.weights[j];
        for (int c = 0; c < 3; ++c) block[4 * c] += value;
      }
}

}  // namespace softreel
