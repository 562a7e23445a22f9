#include "core/elasticity/element_rotation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/elasticity/davenport.h"
#include "core/elasticity/jacobi4.h"

namespace softreel {
namespace {

using detail::adjugate;
using detail::dot;
using detail::Matrix9;
using detail::multiply;
using detail::newton_step;
using detail::scaled;
using detail::shifted;
using detail::smallest_pivot;
using Quad = detail::Quad<double>;
using Symmetric4 = detail::Symmetric4<double>;

constexpr int kRayleighSteps = 4;  ///< from a guess of the last time step two do
constexpr int kNewtonSteps = 60;   ///< at a double root Newton halves its distance with each step

double smaller(double a, double b) {
  return b < a ? b : a;
}

/// The eigenvector that Rayleigh quotient iteration reaches from v, if it is that of the greatest eigenvalue.
std::optional<Quad> polish_and_accept(const Symmetric4& N, Quad v, double first_shift) {
  double shift = first_shift;
  for (int step = 0; step < kRayleighSteps; ++step) {
    const Quad next = multiply(adjugate(shifted(N, shift)), v);
    const double length = std::sqrt(dot(next, next));
    if (!(length > detail::kSmallestAdjugate)) return std::nullopt;
    v = scaled(next, 1.0 / length);
    const Quad product = multiply(N, v);
    shift = dot(v, product);
    double residual = 0;
    for (std::size_t k = 0; k < 4; ++k) residual = std::max(residual, std::abs(product[k] - shift * v[k]));
    if (residual > detail::kResidualTolerance) continue;
    Symmetric4 below = shifted(N, shift + detail::kEigenvalueTolerance);
    for (double& entry : below) entry = -entry;
    if (smallest_pivot(below, smaller) > 0) return v;
    return std::nullopt;
  }
  return std::nullopt;
}

/// Greatest root of the characteristic quartic, from the upper bound sqrt(3) |A|.
double greatest_root(const Matrix9<double>& A) {
  const detail::Quartic<double> quartic = detail::davenport_quartic(A);
  double root = std::sqrt(-1.5 * quartic.c2);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const double change = newton_step(quartic, root);
    if (!(change > 1e-16 * root)) break;
    root -= change;
  }
  return root;
}

/// Column of the greatest diagonal entry: of a matrix that is nearly u u^T, the one with the most digits.
Quad greatest_column(const Symmetric4& m) {
  const std::array<double, 4> diagonal{std::abs(m[0]), std::abs(m[4]), std::abs(m[7]), std::abs(m[9])};
  const auto k = static_cast<std::size_t>(std::max_element(diagonal.begin(), diagonal.end()) - diagonal.begin());
  Quad unit{0, 0, 0, 0};
  unit[k] = 1;
  return multiply(m, unit);
}

/// The quartic's greatest root and its eigenvector; nothing where the root is multiple.
std::optional<Quad> find_by_quartic(const Matrix9<double>& A, const Symmetric4& N) {
  const double root = greatest_root(A);
  const Quad column = greatest_column(adjugate(shifted(N, root)));
  const double length = std::sqrt(dot(column, column));
  if (!(length > detail::kSmallestAdjugate)) return std::nullopt;
  return polish_and_accept(N, scaled(column, 1.0 / length), root);
}

/// Projection of the guess on the eigenspace of the greatest eigenvalue, or its first member if that vanishes.
Quad find_by_eigenspace(const Symmetric4& N, const Quad& guess) {
  const detail::Eigen4 eigen = detail::jacobi_eigen(N);
  const double greatest = *std::max_element(eigen.values.begin(), eigen.values.end());
  Quad projection{0, 0, 0, 0}, first{0, 0, 0, 0};
  bool found = false;
  for (std::size_t k = 0; k < 4; ++k) {
    if (eigen.values[k] < greatest - detail::kEigenvalueTolerance) continue;
    const Quad& u = eigen.vectors[k];
    if (!found) first = u;
    found = true;
    const double share = dot(u, guess);
    for (std::size_t c = 0; c < 4; ++c) projection[c] += share * u[c];
  }
  const double length = std::sqrt(dot(projection, projection));
  return length > 1e-8 ? scaled(projection, 1.0 / length) : first;
}

Quaternion nearest_sign(const Quad& q, const Quad& guess) {
  const double sign = dot(q, guess) < 0 ? -1.0 : 1.0;
  return {sign * q[0], sign * q[1], sign * q[2], sign * q[3]};
}

}  // namespace

Quaternion find_rotation(const Mat3& A, const Quaternion& guess) noexcept {
  const double scale = A.cwiseAbs().maxCoeff();
  if (!A.allFinite() || !(scale > 0)) return guess;
  Matrix9<double> unit;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) unit[static_cast<std::size_t>(3 * r + c)] = A(r, c) / scale;
  const Symmetric4 N = detail::davenport_matrix(unit);
  const Quad start{guess.w(), guess.x(), guess.y(), guess.z()};
  if (const auto warm = polish_and_accept(N, start, dot(start, multiply(N, start)))) return nearest_sign(*warm, start);
  if (const auto cold = find_by_quartic(unit, N)) return nearest_sign(*cold, start);
  return nearest_sign(find_by_eigenspace(N, start), start);
}

Mat3 element_moment(const TetNodes& rest, const TetNodes& deformed) {
  const Vec3 rest_center = 0.25 * (rest[0] + rest[1] + rest[2] + rest[3]);
  const Vec3 center = 0.25 * (deformed[0] + deformed[1] + deformed[2] + deformed[3]);
  Mat3 moment = Mat3::Zero();
  for (std::size_t k = 0; k < 4; ++k) moment += (deformed[k] - center) * (rest[k] - rest_center).transpose();
  return moment;
}

Quaternion find_element_rotation(const TetNodes& rest, const TetNodes& deformed, const Quaternion& guess) noexcept {
  return find_rotation(element_moment(rest, deformed), guess);
}

}  // namespace softreel
