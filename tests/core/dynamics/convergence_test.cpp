/// Order in the element size on a smooth manufactured solution of small strain, on lattice meshes.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/dynamics/linear_system.h"
#include "core/elasticity/assembly.h"
#include "core/multigrid/multigrid.h"
#include "tests/support/elastic_box.h"

namespace softreel {
namespace {

constexpr double kPi = EIGEN_PI;

/// u = a s with s = sin(pi x) sin(pi y) sin(pi z) on the unit cube: zero on its boundary.
struct Manufactured {
  Vec3 a = Vec3(1, -0.5, 0.7);
  ElementMaterial material{1e6, 0.3, 1000, 0, 0};

  static Vec3 sines(const Vec3& x) { return (kPi * x).array().sin(); }
  static Vec3 cosines(const Vec3& x) { return (kPi * x).array().cos(); }

  Vec3 displacement(const Vec3& x) const { return a * sines(x).prod(); }
  Mat3 gradient(const Vec3& x) const {
    const Vec3 s = sines(x), c = cosines(x);
    return a * (kPi * Vec3(c.x() * s.y() * s.z(), s.x() * c.y() * s.z(), s.x() * s.y() * c.z())).transpose();
  }
  /// -div sigma = -((lambda + mu) grad div u + mu laplace u), N/m^3.
  Vec3 body_force(const Vec3& x) const {
    const Vec3 s = sines(x), c = cosines(x);
    const double xy = c.x() * c.y() * s.z(), xz = c.x() * s.y() * c.z(), yz = s.x() * c.y() * c.z(), own = -s.prod();
    Mat3 second;
    second << own, xy, xz, xy, own, yz, xz, yz, own;
    const double lambda = material.lame_lambda(), mu = material.lame_mu();
    return kPi * kPi * (3 * mu * s.prod() * a - (lambda + mu) * second * a);
  }
};

/// Points and weights on a tetrahedron, exact for cubics (Keast 1986, five points).
struct Quadrature {
  std::array<double, 4> at;
  double weight;
};
constexpr std::array<Quadrature, 5> kQuadrature{{{{0.25, 0.25, 0.25, 0.25}, -0.8},
                                                 {{0.5, 1.0 / 6, 1.0 / 6, 1.0 / 6}, 0.45},
                                                 {{1.0 / 6, 0.5, 1.0 / 6, 1.0 / 6}, 0.45},
                                                 {{1.0 / 6, 1.0 / 6, 0.5, 1.0 / 6}, 0.45},
                                                 {{1.0 / 6, 1.0 / 6, 1.0 / 6, 0.5}, 0.45}}};

/// Calls visit(element, point, weight in m^3, barycentric coordinates).
template <typename Visit>
void integrate(const ElasticBody& body, const Visit& visit) {
  for (std::size_t e = 0; e < body.tets.size(); ++e) {
    const TetNodes nodes = nodes_of(body.tets[e], body.rest_positions);
    for (const Quadrature& q : kQuadrature) {
      Vec3 x = Vec3::Zero();
      for (std::size_t k = 0; k < 4; ++k) x += q.at[k] * nodes[k];
      visit(e, x, q.weight * body.shapes[e].volume, q.at);
    }
  }
}

/// Nodal displacements by the assembled matrix at rest and the multigrid solver.
std::vector<Vec3> solve(const TetMesh& mesh, const ElasticBody& body, const Manufactured& exact) {
  const Threads threads(1);
  const std::size_t n = mesh.nodes.size();
  BlockMatrixd matrix{stiffness_pattern(mesh.tets, static_cast<Index>(n)), {}};
  StiffnessTerms terms;
  find_stiffness_terms(body, mesh.nodes, std::vector<Quaternion>(mesh.tets.size(), Quaternion::Identity()),
                       std::vector<double>(mesh.tets.size(), 1.0), Curvature::None, terms, threads);
  StiffnessAssembler(mesh.tets, matrix.pattern).assemble(terms, std::vector<double>(n, 0.0), matrix, threads);
  std::vector<Vec3> load(n, Vec3::Zero()), result(n, Vec3::Zero());
  integrate(body, [&](std::size_t e, const Vec3& x, double weight, const std::array<double, 4>& shares) {
    for (std::size_t k = 0; k < 4; ++k)
      load[static_cast<std::size_t>(body.tets[e][k])] += weight * shares[k] * exact.body_force(x);
  });
  std::vector<std::uint8_t> held(n, 0);
  for (const Triangle& face : boundary_faces(mesh))
    for (const Index node : face) held[static_cast<std::size_t>(node)] = 1;
  for (std::size_t i = 0; i < n; ++i)
    if (held[i] != 0) load[i].setZero();
  eliminate_held(matrix, held, threads);
  Multigrid multigrid(mesh, {}, matrix.pattern, {}, threads);
  multigrid.update(matrix, held);
  EXPECT_TRUE(multigrid.solve(matrix, load, result, 1e-10, 0, 200).ok());
  return result;
}

/// Norms of the error and of its gradient, over those of the solution.
struct Errors {
  double l2, h1;
};

Errors errors_at(Index cubes, const Manufactured& exact) {
  const TetMesh mesh = test_support::make_box({cubes, cubes, cubes}, 1.0 / cubes);
  const ElasticBody body =
      make_elastic_body(mesh, std::vector<ElementMaterial>(mesh.tets.size(), exact.material), Dilatation::Linear);
  const std::vector<Vec3> u = solve(mesh, body, exact);
  double l2 = 0, h1 = 0, norm = 0, gradient_norm = 0;
  integrate(body, [&](std::size_t e, const Vec3& x, double weight, const std::array<double, 4>& shares) {
    Vec3 value = -exact.displacement(x);
    Mat3 gradient = -exact.gradient(x);
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3& at = u[static_cast<std::size_t>(body.tets[e][k])];
      value += shares[k] * at;
      gradient += at * body.shapes[e].gradients.col(static_cast<Index>(k)).transpose();
    }
    l2 += weight * value.squaredNorm();
    h1 += weight * gradient.squaredNorm();
    norm += weight * exact.displacement(x).squaredNorm();
    gradient_norm += weight * exact.gradient(x).squaredNorm();
  });
  return {std::sqrt(l2 / norm), std::sqrt(h1 / gradient_norm)};
}

TEST(LinearTetrahedra, ConvergeWithTheSecondOrderInL2AndTheFirstInH1) {
  const Manufactured exact;
  const Errors coarse = errors_at(4, exact), middle = errors_at(8, exact), fine = errors_at(16, exact);
  EXPECT_NEAR(std::log2(middle.l2 / fine.l2), 2, 0.1);
  EXPECT_NEAR(std::log2(middle.h1 / fine.h1), 1, 0.05);
  EXPECT_GT(std::log2(coarse.l2 / middle.l2), 1.6);
  EXPECT_LT(fine.l2, 0.01);
  RecordProperty("l2", std::to_string(coarse.l2) + " " + std::to_string(middle.l2) + " " + std::to_string(fine.l2));
  RecordProperty("h1", std::to_string(coarse.h1) + " " + std::to_string(middle.h1) + " " + std::to_string(fine.h1));
}

}  // namespace
}  // namespace softreel
