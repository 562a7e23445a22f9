#include "core/multigrid/chebyshev.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/base/check.h"
#include "core/multigrid/smoother_rows.h"

namespace softreel {
namespace {

/// Enough for a bound within some 10 % on meshes of good and of poor tetrahedra.
constexpr int kLanczosSteps = 8;

/// On top of the bound by the last Lanczos residual, which holds unless the start vector misses the top of the
/// spectrum.
constexpr double kSafety = 1.05;

/// The polynomial is small on [largest / kSmoothedShare, largest]: what a lattice of twice the spacing cannot carry.
constexpr double kSmoothedShare = 8;

/// A number in [-1, 1) for an entry of the start vector, the same wherever it runs (Steele, Lea and Flood, Fast
/// splittable pseudorandom number generators, 2014).
double scrambled(std::uint64_t k) {
  k = (k + 1) * 0x9e3779b97f4a7c15u;
  k = (k ^ (k >> 30)) * 0xbf58476d1ce4e5b9u;
  k = (k ^ (k >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>(static_cast<std::int64_t>(k ^ (k >> 31))) * 0x1p-63;
}

template <typename Scalar>
double dot3(const NodeLanes<Scalar>& a, const NodeLanes<Scalar>& b) {
  const Eigen::Array4d product = a.template cast<double>() * b.template cast<double>();
  return product[0] + product[1] + product[2];
}

}  // namespace

template <typename Scalar>
Chebyshev<Scalar>::Chebyshev(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix, int degree)
    : Smoother<Scalar>(level, matrix), degree_(degree) {
  CHECK(degree >= 1);
  const std::size_t size = 4 * static_cast<std::size_t>(level.pattern.rows());
  for (NodeVector<Scalar>* vector : {&direction_, &next_, &residual_, &scaled_}) vector->assign(size, Scalar{0});
}

template <typename Scalar>
bool Chebyshev<Scalar>::update(const Threads& threads) {
  if (!Smoother<Scalar>::update(threads)) return false;
  largest_ = bound_spectrum(threads);
  return std::isfinite(largest_) && largest_ > 0;
}

/// v = start vector with v . D v = 1, scaled = D v, next = 0.
template <typename Scalar>
void Chebyshev<Scalar>::start_lanczos(const Threads& threads) {
  // D v is what can be chosen freely: v then takes no product with D.
  const Rows rows(*this);
  const double square = threads.sum_chunks(level_.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (std::int64_t i = begin; i < end; ++i) {
      // By the place before the colouring; scaled by the block, so that D v is rough whatever the units of the row.
      const auto node = static_cast<std::uint64_t>(level_.rank[static_cast<std::size_t>(i)]);
      const Scalar* const block = matrix_.block(level_.diagonal[static_cast<std::size_t>(i)]);
      for (std::uint64_t k = 0; k < 3; ++k)
        scaled_[static_cast<std::size_t>(4 * i) + k] = static_cast<Scalar>(scrambled(3 * node + k)) * block[4 * k];
      lanes(direction_, i) = rows.solve_diagonal(i, lanes(scaled_, i));
      sum += dot3<Scalar>(lanes(direction_, i), lanes(scaled_, i));
    }
    return sum;
  });
  const auto factor = static_cast<Scalar>(1 / std::sqrt(square));
  for (Scalar& value : direction_) value *= factor;
  for (Scalar& value : scaled_) value *= factor;
  std::fill(next_.begin(), next_.end(), Scalar{0});
}

/// residual = A v - beta D v_before; returns v . residual.
template <typename Scalar>
double Chebyshev<Scalar>::lanczos_product(double previous_beta, const Threads& threads) {
  const Rows rows(*this);
  const auto beta = static_cast<Scalar>(previous_beta);
  return threads.sum_chunks(level_.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (std::int64_t i = begin; i < end; ++i) {
      const NodeLanes<Scalar> product = rows.full_sum(i, direction_.data()) - beta * lanes(next_, i);
      lanes(residual_, i) = product;
      sum += dot3<Scalar>(lanes(direction_, i), product);
    }
    return sum;
  });
}

/// residual -= alpha D v; next = D v; direction = D^-1 residual; returns beta = sqrt(direction . residual).
template <typename Scalar>
double Chebyshev<Scalar>::orthogonalize(double alpha, const Threads& threads) {
  const Rows rows(*this);
  const auto factor = static_cast<Scalar>(alpha);
  const double square = threads.sum_chunks(level_.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (std::int64_t i = begin; i < end; ++i) {
      lanes(residual_, i) -= factor * lanes(scaled_, i);
      lanes(direction_, i) = rows.solve_diagonal(i, lanes(residual_, i));
      sum += dot3<Scalar>(lanes(direction_, i), lanes(residual_, i));
    }
    return sum;
  });
  std::swap(next_, scaled_);
  return std::sqrt(std::max(square, 0.0));
}

/// Lanczos on D^-1 A in the inner product of D: the greatest Ritz value plus the norm of its residual.
template <typename Scalar>
double Chebyshev<Scalar>::bound_spectrum(const Threads& threads) {
  start_lanczos(threads);
  Eigen::Matrix<double, kLanczosSteps, kLanczosSteps> T = Eigen::Matrix<double, kLanczosSteps, kLanczosSteps>::Zero();
  double beta = 0;
  int steps = 0;
  while (steps < kLanczosSteps) {
    const double alpha = lanczos_product(beta, threads);
    if (!std::isfinite(alpha)) return alpha;
    beta = orthogonalize(alpha, threads);
    T(steps, steps) = alpha;
    ++steps;
    // All of the spectrum that the start vector has was found: D^-1 A is the identity, for instance.
    if (!(beta > 1e-6 * std::abs(alpha)) || steps == kLanczosSteps) break;
    T(steps, steps - 1) = T(steps - 1, steps) = beta;
    const auto factor = static_cast<Scalar>(1 / beta);
    for (Scalar& value : direction_) value *= factor;
    std::swap(scaled_, residual_);
    for (Scalar& value : scaled_) value *= factor;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(T.topLeftCorner(steps, steps));
  return kSafety * (ritz.eigenvalues()[steps - 1] + beta * std::abs(ritz.eigenvectors()(steps - 1, steps - 1)));
}

template <typename Scalar>
void Chebyshev<Scalar>::apply(NodeVector<Scalar>& x, NodeVector<Scalar>& r, bool keep_residual,
                              const Threads& threads) {
  const Rows rows(*this);
  const double least = largest_ / kSmoothedShare, middle = 0.5 * (largest_ + least), half = 0.5 * (largest_ - least);
  double rho = half / middle;
  const auto first = static_cast<Scalar>(1 / middle);
  threads.for_chunks(level_.pattern.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(direction_, i) = first * rows.solve_diagonal(i, lanes(r, i));
  });
  for (int k = 1; k <= degree_; ++k) {
    const double next_rho = 1 / (2 * middle / half - rho);
    const auto keep = static_cast<Scalar>(next_rho * rho), add = static_cast<Scalar>(2 * next_rho / half);
    const bool last = k == degree_, product = !last || keep_residual;
    threads.for_chunks(level_.pattern.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        lanes(x, i) += lanes(direction_, i);
        if (!product) continue;
        const NodeLanes<Scalar> left = lanes(r, i) - rows.full_sum(i, direction_.data());
        lanes(r, i) = left;
        if (!last) lanes(next_, i) = keep * lanes(direction_, i) + add * rows.solve_diagonal(i, left);
      }
    });
    std::swap(direction_, next_);
    rho = next_rho;
  }
}

template <typename Scalar>
void Chebyshev<Scalar>::smooth_from_zero(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x,
                                         NodeVector<Scalar>& r, const Threads& threads) {
  CHECK(sweeps >= 1);
  threads.for_chunks(level_.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      lanes(x, i).setZero();
      lanes(r, i) = lanes(b, i);
    }
  });
  for (int sweep = 0; sweep < sweeps; ++sweep) apply(x, r, true, threads);
}

template <typename Scalar>
void Chebyshev<Scalar>::smooth(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) {
  if (sweeps < 1) return;
  this->find_residual(b, x, residual_, threads);
  for (int sweep = 1; sweep <= sweeps; ++sweep) apply(x, residual_, sweep < sweeps, threads);
}

template <typename Scalar>
std::int64_t Chebyshev<Scalar>::bytes() const {
  return Smoother<Scalar>::bytes() + static_cast<std::int64_t>(4 * direction_.size() * sizeof(Scalar));
}

template class Chebyshev<float>;
template class Chebyshev<double>;

}  // namespace softreel
