#include "core/multigrid/gauss_seidel.h"

#include "core/base/check.h"

namespace softreel {

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

template <typename Scalar>
void GaussSeidel<Scalar>::smooth_from_zero(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x,
                                           NodeVector<Scalar>& r, const Threads& threads) {
  CHECK(sweeps >= 1);
  forward_from_zero(b, x, threads);
  if (directions_ == SweepDirections::OneWay) {
    for (int sweep = 1; sweep < sweeps; ++sweep) forward(b, x, threads);
    if (sweeps == 1) return find_residual_from_zero(x, r, threads);
    return this->find_residual(b, x, r, threads);
  }
  backward(b, x, threads);
  smooth(sweeps - 1, b, x, threads);
  find_smoothed_residual(b, x, r, threads);
}

template <typename Scalar>
void GaussSeidel<Scalar>::smooth(int sweeps, const NodeVector<Scalar>& b, NodeVector<Scalar>& x,
                                 const Threads& threads) {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    if (directions_ == SweepDirections::OneWay) {
      backward_alone(b, x, threads);
    } else {
      forward(b, x, threads);
      backward(b, x, threads);
    }
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
  return Smoother<Scalar>::bytes() + static_cast<std::int64_t>(left_sums_.size() * sizeof(Scalar));
}

template class GaussSeidel<float>;
template class GaussSeidel<double>;

}  // namespace softreel
