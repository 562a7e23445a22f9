#include "core/elasticity/jacobi4.h"

#include <cmath>
#include <cstddef>

namespace softreel::detail {
namespace {

constexpr int kMaxSweeps = 20;  ///< convergence is quadratic: 4 to 6 do

using Full4 = std::array<std::array<double, 4>, 4>;

/// Zeroes a[p][q] by a rotation in the plane (p, q), and turns the eigenvectors (rows of v) with it.
void rotate(Full4& a, Full4& v, std::size_t p, std::size_t q) {
  if (a[p][q] == 0) return;
  const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
  const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::hypot(theta, 1.0));
  const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
  for (std::size_t k = 0; k < 4; ++k) {
    const double kp = a[k][p], kq = a[k][q];
    a[k][p] = c * kp - s * kq;
    a[k][q] = s * kp + c * kq;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const double pk = a[p][k], qk = a[q][k], vp = v[p][k], vq = v[q][k];
    a[p][k] = c * pk - s * qk;
    a[q][k] = s * pk + c * qk;
    v[p][k] = c * vp - s * vq;
    v[q][k] = s * vp + c * vq;
  }
  a[p][q] = a[q][p] = 0;
}

double off_diagonal(const Full4& a) {
  double sum = 0;
  for (std::size_t p = 0; p < 4; ++p)
    for (std::size_t q = p + 1; q < 4; ++q) sum += std::abs(a[p][q]);
  return sum;
}

}  // namespace

Eigen4 jacobi_eigen(const Symmetric4<double>& m) {
  Full4 a{{{m[0], m[1], m[2], m[3]}, {m[1], m[4], m[5], m[6]}, {m[2], m[5], m[7], m[8]}, {m[3], m[6], m[8], m[9]}}};
  Full4 v{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  double scale = 0;
  for (const double entry : m) scale += std::abs(entry);
  for (int sweep = 0; sweep < kMaxSweeps && off_diagonal(a) > 1e-18 * scale; ++sweep)
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = p + 1; q < 4; ++q) rotate(a, v, p, q);
  return {{a[0][0], a[1][1], a[2][2], a[3][3]}, {v[0], v[1], v[2], v[3]}};
}

}  // namespace softreel::detail
