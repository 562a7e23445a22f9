#include "core/multigrid/gauss_seidel.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/multigrid/smoother_rows.h"

namespace softreel {
namespace {

/// Of the spectrum (0, 1] of a sweep times A, what `sweeps` sweeps are to take care of: [kSmoothedFrom / sweeps, 1].
/// Tuned for the iterations of the benchmark iteration_counts at Poisson's ratio 0.49, which hardly depend on it.
constexpr double kSmoothedFrom = 0.45;

}  // namespace

std::vector<double> sweep_weights(int sweeps) {
  if (sweeps == 1) return {1.0};
  const double from = kSmoothedFrom / sweeps, middle = 0.5 * (1 + from), half = 0.5 * (1 - from);
  std::vector<double> weights;
  for (int k = 0; k < sweeps; ++k)
    weights.push_back(1 / (middle - half * std::cos(std::numbers::pi * (2 * k + 1) / (2.0 * sweeps))));
  return weights;
}

template <typename Scalar>
GaussSeidel<Scalar>::GaussSeidel(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix,
                                 SweepDirections directions)
    : Smoother<Scalar>(level, matrix), directions_(directions) {
  left_sums_.assign(4 * static_cast<std::size_t>(level.pattern.rows()), Scalar{0});
}

template <typename Scalar>
template <typename RowUpdate>
void GaussSeidel<Scalar>::for_color(std::size_t color, const Threads& threads, const RowUpdate& update) const {
  const std::int64_t first = level_.color_offsets[color], count = level_.color_offsets[color + 1] - first;
  threads.for_chunks(count, kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = first + begin; i < first + end; ++i) update(i);
  });
}

template <typename Scalar>
void GaussSeidel<Scalar>::forward_from_zero(const NodeVector<Scalar>& b, NodeVector<Scalar>& x,
                                            const Threads& threads) {
  const Rows rows(*this);
  for (std::size_t color = 0; color + 1 < level_.color_offsets.size(); ++color)
    for_color(color, threads, [&](std::int64_t i) {
      const NodeLanes<Scalar> left = rows.left_sum(i, x.data());
      lanes(left_sums_, i) = left;
      lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - left);
    });
}

template <typename Scalar>
void GaussSeidel<Scalar>::forward(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) {
  const Rows rows(*this);
  for (std::size_t color = 0; color + 1 < level_.color_offsets.size(); ++color)
    for_color(color, threads, [&](std::int64_t i) {
      const NodeLanes<Scalar> left = rows.left_sum(i, x.data());
      lanes(left_sums_, i) = left;
      lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - left - rows.right_sum(i, x.data()));
    });
}

template <typename Scalar>
void GaussSeidel<Scalar>::backward(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) {
  const Rows rows(*this);
  for (std::size_t color = level_.color_offsets.size() - 1; color-- > 0;)
    for_color(color, threads, [&](std::int64_t i) {
      lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - lanes(left_sums_, i) - rows.right_sum(i, x.data()));
    });
}

template <typename Scalar>
void GaussSeidel<Scalar>::backward_alone(const NodeVector<Scalar>& b, NodeVector<Scalar>& x, const Threads& threads) {
  const Rows rows(*this);
  for (std::size_t color = level_.color_offsets.size() - 1; color-- > 0;)
    for_color(color, threads, [&](std::int64_t i) {
      const NodeLanes<Scalar> left = rows.left_sum(i, x.data());
      lanes(left_sums_, i) = left;
      lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - left - rows.right_sum(i, x.data()));
    });
}

/// x = x_old + w (x_s - x_old) for x_s of a plain sweep from x_old. What that leaves of b but for L x is
/// b - (D + U) x = w (b - (D + U) x_s) + (1 - w) (b - (D + U) x_old), where b - (D + U) x_s are the left sums of the
/// plain sweep and (D + U) x_old comes with its forward half.
template <typename Scalar>
template <typename GaussSeidel<Scalar>::Start start>
void GaussSeidel<Scalar>::weighted_sweep(double weight, const NodeVector<Scalar>& b, NodeVector<Scalar>& x,
                                         const Threads& threads) {
  const Rows rows(*this);
  const auto w = static_cast<Scalar>(weight), more = static_cast<Scalar>(weight - 1);
  for (NodeVector<Scalar>* vector : {&before_, &rest_}) vector->resize(x.size());
  for (std::size_t color = 0; color + 1 < level_.color_offsets.size(); ++color)
    for_color(color, threads, [&](std::int64_t i) {
      const NodeLanes<Scalar> left = rows.left_sum(i, x.data());
      lanes(left_sums_, i) = left;
      if constexpr (start == Start::FromZero) {
        lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - left);
      } else {
        const NodeLanes<Scalar> rest = rows.rest_sum(i, x.data());
        lanes(rest_, i) = rest;
        lanes(before_, i) = lanes(x, i);
        lanes(x, i) += rows.solve_diagonal(i, lanes(b, i) - left - rest);
      }
    });
  for (std::size_t color = level_.color_offsets.size() - 1; color-- > 0;)
    for_color(color, threads, [&](std::int64_t i) {
      const NodeLanes<Scalar> left = lanes(left_sums_, i);
      lanes(x, i) = rows.solve_diagonal(i, lanes(b, i) - left - rows.right_sum(i, x.data()));
      NodeLanes<Scalar> left_over = w * left - more * lanes(b, i);
      if constexpr (start == Start::FromX) left_over += more * lanes(rest_, i);
      left_over[3] = 0;  // or b's would come back to it, larger each time
      lanes(left_sums_, i) = left_over;
    });
  threads.for_chunks(level_.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      if constexpr (start == Start::FromZero)
        lanes(x, i) *= w;
      else
        lanes(x, i) += more * (lanes(x, i) - lanes(before_, i));
    }
  });
}

template <typename Scalar>
void GaussSeidel<Scalar>::smooth_from_zero(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x,
                                           NodeVector<Scalar>& r, const Threads& threads) {
  CHECK(sweeps >= 1);
  if (directions_ == SweepDirections::OneWay) {
    forward_from_zero(b, x, threads);
    for (int sweep = 1; sweep < sweeps; ++sweep) forward(b, x, threads);
    if (sweeps == 1) return find_residual_from_zero(x, r, threads);
    return this->find_residual(b, x, r, threads);
  }
  if (sweeps == 1) {
    forward_from_zero(b, x, threads);
    backward(b, x, threads);
  } else {
    const std::vector<double> weights = sweep_weights(sweeps);
    weighted_sweep<Start::FromZero>(weights.front(), b, x, threads);
    for (std::size_t k = 1; k < weights.size(); ++k) weighted_sweep<Start::FromX>(weights[k], b, x, threads);
  }
  find_smoothed_residual(b, x, r, threads);
}

template <typename Scalar>
void GaussSeidel<Scalar>::smooth(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x,
                                 const Threads& threads) {
  if (directions_ == SweepDirections::OneWay) {
    for (int sweep = 0; sweep < sweeps; ++sweep) backward_alone(b, x, threads);
  } else if (sweeps == 1) {
    forward(b, x, threads);
    backward(b, x, threads);
  } else {
    // The weights in any order make the same polynomial: this smoothing is the adjoint of that from zero.
    for (const double weight : sweep_weights(sweeps)) weighted_sweep<Start::FromX>(weight, b, x, threads);
  }
}

/// Each row was solved while all to its right was zero: only that is missing.
template <typename Scalar>
void GaussSeidel<Scalar>::find_residual_from_zero(const NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                                                  const Threads& threads) const {
  const Rows rows(*this);
  threads.for_chunks(level_.pattern.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(r, i) = -rows.right_sum(i, x.data());
  });
}

template <typename Scalar>
void GaussSeidel<Scalar>::find_smoothed_residual(const NodeVector<Scalar>&, const NodeVector<Scalar>& x,
                                                 NodeVector<Scalar>& r, const Threads& threads) const {
  const Rows rows(*this);
  threads.for_chunks(level_.pattern.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(r, i) = lanes(left_sums_, i) - rows.left_sum(i, x.data());
  });
}

template <typename Scalar>
std::int64_t GaussSeidel<Scalar>::bytes() const {
  return Smoother<Scalar>::bytes() +
         static_cast<std::int64_t>((left_sums_.size() + before_.size() + rest_.size()) * sizeof(Scalar));
}

template class GaussSeidel<float>;
template class GaussSeidel<double>;

}  // namespace softreel
