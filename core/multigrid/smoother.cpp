#include "core/multigrid/smoother.h"

#include <cmath>

#include "core/multigrid/chebyshev.h"
#include "core/multigrid/gauss_seidel.h"
#include "core/multigrid/smoother_rows.h"

namespace softreel {
namespace {

/// A block counts as positive definite if its determinant is this share of the product of its diagonal: above the
/// rounding of the cofactors.
constexpr double kLeastDeterminant = 1e-14;

/// Inverse of a symmetric 3x3 block by cofactors, in double, as 3 columns of 4 lanes; false, and nothing stored, if the
/// block is not positive definite.
template <typename Scalar>
bool invert(const Scalar* block, Scalar* inverse) {
  const auto at = [&](int k) { return static_cast<double>(block[k]); };
  const double a = at(0), b = 0.5 * (at(1) + at(3)), c = 0.5 * (at(2) + at(6)), d = at(4), e = 0.5 * (at(5) + at(7)),
               f = at(8);
  const double c00 = d * f - e * e, c01 = c * e - b * f, c02 = b * e - c * d;
  const double c11 = a * f - c * c, c12 = b * c - a * e, c22 = a * d - b * b;
  const double determinant = a * c00 + b * c01 + c * c02;
  // Cofactors cancel where the block is nearly singular: then the sign of the determinant means nothing.
  if (!(a > 0 && c22 > 0 && determinant > kLeastDeterminant * (a * d) * f) || !std::isfinite(determinant)) return false;
  const double scale = 1 / determinant;
  const double entries[9] = {c00, c01, c02, c01, c11, c12, c02, c12, c22};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      inverse[4 * column + row] = static_cast<Scalar>(entries[3 * column + row] * scale);
  return true;
}

}  // namespace

template <typename Scalar>
Smoother<Scalar>::Smoother(const LatticeLevel& level, const BlockMatrix<Scalar>& matrix)
    : level_(level), matrix_(matrix) {
  inverses_.assign(12 * static_cast<std::size_t>(level.pattern.rows()), Scalar{0});
}

template <typename Scalar>
bool Smoother<Scalar>::update(const Threads& threads) {
  const double failures =
      threads.sum_chunks(level_.pattern.rows(), kRowGrain, [&](std::int64_t begin, std::int64_t end) {
        double failed = 0;
        for (std::int64_t i = begin; i < end; ++i)
          if (!invert(matrix_.block(level_.diagonal[static_cast<std::size_t>(i)]), inverses_.data() + 12 * i)) ++failed;
        return failed;
      });
  return failures == 0;
}

template <typename Scalar>
void Smoother<Scalar>::find_residual(const NodeVector<Scalar>& b, const NodeVector<Scalar>& x, NodeVector<Scalar>& r,
                                     const Threads& threads) const {
  const Rows rows(*this);
  threads.for_chunks(level_.pattern.rows(), kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) lanes(r, i) = lanes(b, i) - rows.full_sum(i, x.data());
  });
}

template <typename Scalar>
std::unique_ptr<Smoother<Scalar>> make_smoother(const MultigridParams& params, const LatticeLevel& level,
                                                const BlockMatrix<Scalar>& matrix) {
  switch (params.smoother) {
    case SmootherKind::GaussSeidel:
      return std::make_unique<GaussSeidel<Scalar>>(level, matrix, SweepDirections::Both);
    case SmootherKind::OneWayGaussSeidel:
      return std::make_unique<GaussSeidel<Scalar>>(level, matrix, SweepDirections::OneWay);
    case SmootherKind::Chebyshev:
      return std::make_unique<Chebyshev<Scalar>>(level, matrix, params.chebyshev_degree);
  }
  return nullptr;
}

template class Smoother<float>;
template class Smoother<double>;
template std::unique_ptr<Smoother<float>> make_smoother(const MultigridParams&, const LatticeLevel&,
                                                        const BlockMatrixf&);
template std::unique_ptr<Smoother<double>> make_smoother(const MultigridParams&, const LatticeLevel&,
                                                         const BlockMatrixd&);

}  // namespace softreel
