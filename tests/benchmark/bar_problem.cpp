#include "tests/benchmark/bar_problem.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <random>

#include "core/dynamics/linear_system.h"
#include "core/elasticity/assembly.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/mass.h"

namespace softreel::benchmark_support {
namespace {

constexpr double kTwist = std::numbers::pi, kBend = 86 * std::numbers::pi / 180;
constexpr double kNoise = 0.1;
constexpr unsigned kSeed = 20081;

struct Box {
  explicit Box(const std::vector<Vec3>& points) : low(points.front()), high(points.front()) {
    for (const Vec3& p : points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  Vec3 low, high;
};

/// Elastic forces and weight on the nodes, N.
std::vector<Vec3> find_forces(const ElasticBody& body, const NodalMasses& masses, const std::vector<Vec3>& positions,
                              const std::vector<Quaternion>& rotations, const Threads& threads) {
  std::vector<Mat3> stresses(body.tets.size());
  std::vector<Vec3> forces(positions.size());
  find_stresses(body, positions, rotations, stresses, threads);
  gather_forces(body, stresses, forces, threads);
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] += masses.mass[i] * Vec3(0, -9.81, 0);
  return forces;
}

}  // namespace

std::string name_of(SystemKind kind) {
  return kind == SystemKind::Dynamic ? "dynamic" : "static";
}

std::vector<Vec3> deform_bar(const std::vector<Vec3>& rest, double element_size) {
  const Box box(rest);
  const double length = box.high[0] - box.low[0], radius = length / kBend;
  const Vec3 middle = 0.5 * (box.low + box.high);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> noise(-kNoise * element_size, kNoise * element_size);
  std::vector<Vec3> deformed;
  for (const Vec3& X : rest) {
    const double part = (X[0] - box.low[0]) / length, twist = part * kTwist, bend = part * kBend;
    const double y0 = X[1] - middle[1], z0 = X[2] - middle[2];
    const double y = std::cos(twist) * y0 - std::sin(twist) * z0, z = std::sin(twist) * y0 + std::cos(twist) * z0;
    Vec3 x(std::sin(bend) * (radius - y), middle[1] + radius - std::cos(bend) * (radius - y), middle[2] + z);
    const double a = noise(random), b = noise(random), c = noise(random);
    if (part > 0) x += Vec3(a, b, c);
    deformed.push_back(x);
  }
  return deformed;
}

LinearSystem make_system(const TetMesh& mesh, const std::vector<ElementMaterial>& materials,
                         const std::vector<Vec3>& positions, SystemKind kind, const Threads& threads) {
  const bool dynamic = kind == SystemKind::Dynamic;
  const std::size_t nodes = mesh.nodes.size();
  const ElasticBody body = make_elastic_body(mesh, materials, Dilatation::Linear);
  const NodalMasses masses = lump_masses(mesh, materials);
  std::vector<Quaternion> rotations(mesh.tets.size(), Quaternion::Identity());
  find_rotations(body, RotationMethod::Consistent, positions, rotations, threads);
  std::vector<double> shares(mesh.tets.size(), 1.0), node_terms(nodes, 0.0);
  if (dynamic) {
    for (std::size_t e = 0; e < shares.size(); ++e) shares[e] = kBarStep * (kBarStep + materials[e].damping_stiffness);
    for (std::size_t i = 0; i < nodes; ++i) node_terms[i] = masses.mass[i] + kBarStep * masses.damping[i];
  }
  LinearSystem system;
  system.matrix.pattern = stiffness_pattern(mesh.tets, static_cast<Index>(nodes));
  StiffnessTerms terms;
  find_stiffness_terms(body, positions, rotations, shares, dynamic ? Curvature::None : Curvature::PositivePart, terms,
                       threads);
  StiffnessAssembler(mesh.tets, system.matrix.pattern).assemble(terms, node_terms, system.matrix, threads);
  system.load = find_forces(body, masses, positions, rotations, threads);
  const double low = Box(mesh.nodes).low[0];
  for (std::size_t i = 0; i < nodes; ++i) {
    system.pinned.push_back(mesh.nodes[i][0] <= low ? 1 : 0);
    system.load[i] *= system.pinned[i] != 0 ? 0.0 : dynamic ? kBarStep : 1.0;
  }
  eliminate_held(system.matrix, system.pinned, threads);
  return system;
}

Index cubes_for(double tets) {
  return std::max(2, static_cast<Index>(std::lround(std::cbrt(tets / 48))));
}

double now(const Threads& threads) {
  timespec time{};
  clock_gettime(threads.count() == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace softreel::benchmark_support
