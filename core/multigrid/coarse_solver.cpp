#include "core/multigrid/coarse_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"

namespace softreel {
namespace {

Index degree(const BlockPattern& pattern, Index i) {
  const auto row = static_cast<std::size_t>(i);
  return static_cast<Index>(pattern.row_offsets[row + 1] - pattern.row_offsets[row]);
}

/// Nodes in breadth-first order from `start`, neighbours by ascending degree; marks them in `visited` by `stamp`.
std::vector<Index> breadth_first(const BlockPattern& pattern, Index start, std::uint8_t stamp,
                                 std::vector<std::uint8_t>& visited) {
  std::vector<Index> order{start}, neighbors;
  visited[static_cast<std::size_t>(start)] = stamp;
  for (std::size_t head = 0; head < order.size(); ++head) {
    const auto row = static_cast<std::size_t>(order[head]);
    neighbors.clear();
    for (std::int64_t b = pattern.row_offsets[row]; b < pattern.row_offsets[row + 1]; ++b) {
      const Index column = pattern.column_indices[static_cast<std::size_t>(b)];
      if (visited[static_cast<std::size_t>(column)] == stamp) continue;
      visited[static_cast<std::size_t>(column)] = stamp;
      neighbors.push_back(column);
    }
    std::stable_sort(neighbors.begin(), neighbors.end(),
                     [&](Index a, Index b) { return degree(pattern, a) < degree(pattern, b); });
    order.insert(order.end(), neighbors.begin(), neighbors.end());
  }
  return order;
}

/// Reverse Cuthill-McKee, each piece from the far end of a first search.
std::vector<Index> elimination_order(const BlockPattern& pattern) {
  std::vector<std::uint8_t> visited(static_cast<std::size_t>(pattern.rows()), 0);
  std::vector<Index> order;
  for (Index i = 0; i < pattern.rows(); ++i) {
    if (visited[static_cast<std::size_t>(i)] != 0) continue;
    const Index far_end = breadth_first(pattern, i, 1, visited).back();
    const std::vector<Index> piece = breadth_first(pattern, far_end, 2, visited);
    order.insert(order.end(), piece.begin(), piece.end());
  }
  std::reverse(order.begin(), order.end());
  return order;
}

/// First node, by place, of the envelope of each place.
std::vector<Index> envelope(const BlockPattern& pattern, const std::vector<Index>& order,
                            const std::vector<Index>& place) {
  std::vector<Index> first;
  for (std::size_t p = 0; p < order.size(); ++p) {
    const auto row = static_cast<std::size_t>(order[p]);
    first.push_back(static_cast<Index>(p));
    for (std::int64_t b = pattern.row_offsets[row]; b < pattern.row_offsets[row + 1]; ++b) {
      const Index column = pattern.column_indices[static_cast<std::size_t>(b)];
      first.back() = std::min(first.back(), place[static_cast<std::size_t>(column)]);
    }
  }
  return first;
}

/// Dot product in 8 lanes: the order of summation is fixed by the length alone.
double dot(const double* a, const double* b, std::int64_t n) {
  using Lanes = Eigen::Array<double, 8, 1>;
  Lanes sum = Lanes::Zero();
  std::int64_t k = 0;
  for (; k + 8 <= n; k += 8) sum += Eigen::Map<const Lanes>(a + k) * Eigen::Map<const Lanes>(b + k);
  double tail = 0;
  for (; k < n; ++k) tail += a[k] * b[k];
  return sum.sum() + tail;
}

/// Dot products of three rows with three rows, 9 sums in 4 lanes each: 6 loads for 9 multiply-adds. entry (r, c) of the
/// result is a_r . b_c.
std::array<double, 9> dot_rows(const std::array<double*, 3>& a, const std::array<double*, 3>& b, std::int64_t n) {
  using Lanes = Eigen::Array4d;
  using Map = Eigen::Map<const Lanes>;
  std::array<Lanes, 9> sums;
  sums.fill(Lanes::Zero());
  std::int64_t k = 0;
  for (; k + 4 <= n; k += 4) {
    const Lanes b0 = Map(b[0] + k), b1 = Map(b[1] + k), b2 = Map(b[2] + k);
    for (std::size_t r = 0; r < 3; ++r) {
      const Lanes a_r = Map(a[r] + k);
      sums[3 * r] += a_r * b0;
      sums[3 * r + 1] += a_r * b1;
      sums[3 * r + 2] += a_r * b2;
    }
  }
  std::array<double, 9> result;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      double tail = 0;
      for (std::int64_t t = k; t < n; ++t) tail += a[r][t] * b[c][t];
      result[3 * r + c] = sums[3 * r + c].sum() + tail;
    }
  return result;
}

}  // namespace

std::vector<Index> inverted(const std::vector<Index>& order) {
  std::vector<Index> place(order.size());
  for (std::size_t p = 0; p < order.size(); ++p) place[static_cast<std::size_t>(order[p])] = static_cast<Index>(p);
  return place;
}

double factor_work(const BlockPattern& pattern) {
  const std::vector<Index> order = elimination_order(pattern);
  const std::vector<Index> first = envelope(pattern, order, inverted(order));
  double work = 0;
  for (std::size_t p = 0; p < first.size(); ++p) {
    const double width = 3.0 * (static_cast<double>(p) - first[p] + 1);
    work += 3 * 0.5 * width * width;
  }
  return work;
}

CoarseSolver::CoarseSolver(const BlockPattern& pattern) {
  const std::vector<Index> order = elimination_order(pattern);
  place_ = inverted(order);
  const std::vector<Index> first = envelope(pattern, order, place_);
  std::int64_t size = 0;
  for (std::size_t p = 0; p < order.size(); ++p)
    for (Index k = 0; k < 3; ++k) {
      first_.push_back(3 * first[p]);
      row_offsets_.push_back(size);
      size += 3 * static_cast<Index>(p) + k - 3 * first[p] + 1;
    }
  factor_.resize(static_cast<std::size_t>(size));
  inverse_pivots_.resize(first_.size());
  work_.resize(first_.size());
}

template <typename Scalar>
bool CoarseSolver::factor(const BlockMatrix<Scalar>& matrix, double noise) {
  const BlockPattern& pattern = matrix.pattern;
  CHECK(static_cast<std::size_t>(pattern.rows()) == place_.size());
  std::fill(factor_.begin(), factor_.end(), 0.0);
  for (std::size_t node = 0; node < place_.size(); ++node)
    for (std::int64_t b = pattern.row_offsets[node]; b < pattern.row_offsets[node + 1]; ++b) {
      const Index p = place_[node],
                  q = place_[static_cast<std::size_t>(pattern.column_indices[static_cast<std::size_t>(b)])];
      for (Index r = 0; r < 3; ++r)
        for (Index c = 0; c < 3; ++c)
          if (3 * q + c <= 3 * p + r)
            row(static_cast<std::size_t>(3 * p + r))[3 * q + c] = static_cast<double>(matrix.block(b)[3 * c + r]);
    }
  bool sound = true;
  for (std::size_t p = 0; p < place_.size(); ++p) sound = factor_node(p, noise) && sound;
  return sound;
}

bool CoarseSolver::factor_node(std::size_t p, double noise) {
  const std::array<double*, 3> rows{row(3 * p), row(3 * p + 1), row(3 * p + 2)};
  const Index first = first_[3 * p];
  for (auto q = static_cast<std::size_t>(first / 3); q < p; ++q) {
    const std::array<double*, 3> others{row(3 * q), row(3 * q + 1), row(3 * q + 2)};
    const Index begin = std::max(first, first_[3 * q]), end = 3 * static_cast<Index>(q);
    const auto from = [&](const std::array<double*, 3>& pointers) {
      return std::array<double*, 3>{pointers[0] + begin, pointers[1] + begin, pointers[2] + begin};
    };
    const std::array<double, 9> sums = dot_rows(from(rows), from(others), end - begin);
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) {
        double value = rows[r][3 * q + c] - sums[3 * r + c];
        for (std::size_t k = 0; k < c; ++k) value -= rows[r][3 * q + k] * others[c][3 * q + k];
        rows[r][3 * q + c] = value * inverse_pivots_[3 * q + c];
      }
  }
  bool sound = true;
  for (std::size_t i = 3 * p; i < 3 * p + 3; ++i) sound = factor_diagonal(i, 3 * p, noise) && sound;
  return sound;
}

bool CoarseSolver::factor_diagonal(std::size_t i, std::size_t done, double noise) {
  double* const L_i = row(i);
  for (std::size_t j = done; j < i; ++j)
    L_i[j] =
        (L_i[j] - dot(L_i + first_[i], row(j) + first_[i], static_cast<Index>(j) - first_[i])) * inverse_pivots_[j];
  const double diagonal = L_i[i];
  const auto width = static_cast<std::int64_t>(i) - first_[i];
  const double pivot = diagonal - dot(L_i + first_[i], L_i + first_[i], width);
  const bool independent = pivot > noise * diagonal;
  L_i[i] = independent ? std::sqrt(pivot) : 0.0;
  inverse_pivots_[i] = independent ? 1.0 / L_i[i] : 0.0;
  // Noise may be negative; anything worse says that the matrix is not semidefinite.
  return std::isfinite(pivot) && diagonal >= 0 && pivot >= -100 * noise * diagonal;
}

template <typename Scalar>
void CoarseSolver::solve(const NodeVector<Scalar>& b, NodeVector<Scalar>& x) {
  double* const y = work_.data();
  for (std::size_t node = 0; node < place_.size(); ++node)
    for (std::size_t c = 0; c < 3; ++c)
      y[3 * static_cast<std::size_t>(place_[node]) + c] = static_cast<double>(b[4 * node + c]);
  for (std::size_t i = 0; i < first_.size(); ++i) {
    const Index begin = first_[i];
    y[i] = (y[i] - dot(row(i) + begin, y + begin, static_cast<Index>(i) - begin)) * inverse_pivots_[i];
  }
  for (std::size_t i = first_.size(); i-- > 0;) {
    y[i] *= inverse_pivots_[i];
    const double* const L_i = row(i);
    for (auto j = static_cast<std::size_t>(first_[i]); j < i; ++j) y[j] -= L_i[j] * y[i];
  }
  for (std::size_t node = 0; node < place_.size(); ++node) {
    for (std::size_t c = 0; c < 3; ++c)
      x[4 * node + c] = static_cast<Scalar>(y[3 * static_cast<std::size_t>(place_[node]) + c]);
    x[4 * node + 3] = 0;
  }
}

std::int64_t CoarseSolver::bytes() const {
  return static_cast<std::int64_t>(factor_.size() * sizeof(double));
}

template bool CoarseSolver::factor(const BlockMatrixf&, double);
template bool CoarseSolver::factor(const BlockMatrixd&, double);
template void CoarseSolver::solve(const NodeVector<float>&, NodeVector<float>&);
template void CoarseSolver::solve(const NodeVector<double>&, NodeVector<double>&);

}  // namespace softreel
