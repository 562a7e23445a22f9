/// Flexible GMRES: solves what is neither symmetric nor definite, with a preconditioner that may itself iterate.
///
/// Saad, A flexible inner-outer preconditioned GMRES algorithm, SIAM J. Sci. Comput. 1993.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// out = A in, or nearly its inverse.
using VectorMap = std::function<void(std::span<const Vec3> in, std::span<Vec3> out)>;

struct GmresReport {
  int iterations = 0;
  double residual = 1;  ///< |b - A x| over |b|, as the recurrence has it
};

/// x with |b - A x| <= tolerance |b|, from zero and without a restart; the best there is after max_iterations. Keeps
/// 2 * max_iterations vectors at most. Sums run in the order of the entries.
GmresReport solve_by_gmres(const VectorMap& apply, const VectorMap& precondition, std::span<const Vec3> b,
                           double tolerance, int max_iterations, std::span<Vec3> x);

}  // namespace softreel
