#include "core/dynamics/flexible_gmres.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "core/dynamics/inner_product.h"

namespace softreel {
namespace {

void add(double factor, std::span<const Vec3> a, std::span<Vec3> sum) {
  for (std::size_t i = 0; i < a.size(); ++i) sum[i] += factor * a[i];
}

void scale(double factor, std::span<Vec3> a) {
  for (Vec3& v : a) v *= factor;
}

/// Weights y of the search directions that minimise |beta e_1 - H y|, and that minimum.
struct LeastSquares {
  Eigen::VectorXd weights;
  double residual;
};

LeastSquares solve_hessenberg(const Eigen::MatrixXd& hessenberg, double beta, Eigen::Index columns) {
  Eigen::VectorXd right_side = Eigen::VectorXd::Zero(columns + 1);
  right_side[0] = beta;
  const Eigen::MatrixXd H = hessenberg.topLeftCorner(columns + 1, columns);
  const Eigen::VectorXd weights = H.colPivHouseholderQr().solve(right_side);
  return {weights, (right_side - H * weights).norm()};
}

}  // namespace

GmresReport solve_by_gmres(const VectorMap& apply, const VectorMap& precondition, std::span<const Vec3> b,
                           double tolerance, int max_iterations, std::span<Vec3> x) {
  GmresReport report;
  std::fill(x.begin(), x.end(), Vec3::Zero());
  const double beta = std::sqrt(dot(b, b));
  if (!(beta > 0) || !std::isfinite(beta)) return report;
  std::vector<std::vector<Vec3>> basis{{b.begin(), b.end()}}, directions;
  scale(1 / beta, basis[0]);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(max_iterations + 1, max_iterations);
  LeastSquares best{Eigen::VectorXd(), beta};
  for (Eigen::Index k = 0; k < max_iterations; ++k) {
    std::vector<Vec3> direction(b.size()), image(b.size());
    precondition(basis.back(), direction);
    apply(direction, image);
    // Twice, so that the basis is orthogonal to round-off.
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t i = 0; i < basis.size(); ++i) {
        const double share = dot(basis[i], image);
        H(static_cast<Eigen::Index>(i), k) += share;
        add(-share, basis[i], image);
      }
    const double length = std::sqrt(dot(image, image));
    if (!std::isfinite(length)) break;
    H(k + 1, k) = length;
    directions.push_back(std::move(direction));
    report.iterations += 1;
    best = solve_hessenberg(H, beta, k + 1);
    if (best.residual <= tolerance * beta || !(length > 0)) break;
    scale(1 / length, image);
    basis.push_back(std::move(image));
  }
  for (std::size_t k = 0; k < directions.size(); ++k) add(best.weights[static_cast<Eigen::Index>(k)], directions[k], x);
  report.residual = best.residual / beta;
  return report;
}

}  // namespace softreel
