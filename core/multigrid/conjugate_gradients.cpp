#include "core/multigrid/conjugate_gradients.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"

namespace softreel {
namespace {

/// Iterations that must at least halve the residual; a sound cycle needs two or three.
constexpr int kStagnation = 25;

/// The residual of the best answer in double is a few units of rounding of |A| |x| + |b|; this many at most.
constexpr double kRoundingUnits = 4;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

bool is_zero(const NodeVector<double>& vector) {
  return std::all_of(vector.begin(), vector.end(), [](double value) { return value == 0; });
}

/// Largest diagonal entry: a cheap scale of |A|.
double largest_diagonal(const BlockMatrixd& A) {
  double largest = 0;
  for (Index i = 0; i < A.pattern.rows(); ++i) {
    const double* const block = A.block(A.pattern.find(i, i));
    largest = std::max({largest, block[0], block[4], block[8]});
  }
  return largest;
}

}  // namespace

SolveReport ConjugateGradients::solve(const BlockMatrixd& A, std::span<const Vec3> b, std::span<Vec3> x,
                                      const CgLimits& limits, const Preconditioner& preconditioner) {
  CHECK(b.size() == x.size());
  CHECK(static_cast<std::size_t>(A.pattern.rows()) == b.size());
  start(A, b, x);
  SolveReport report;
  if (b_norm_ == 0) {
    std::fill(x.begin(), x.end(), Vec3::Zero());
    return report;
  }
  report.status = iterate(A, limits, preconditioner, report.iterations);
  report.residual = r_norm_ / b_norm_;
  unpack(x_, x);
  return report;
}

void ConjugateGradients::start(const BlockMatrixd& A, std::span<const Vec3> b, std::span<Vec3> x) {
  pack(b, b_);
  pack(x, x_);
  for (NodeVector<double>* vector : {&r_, &z_, &p_, &q_}) vector->assign(b_.size(), 0.0);
  b_norm_ = std::sqrt(dot(b_, b_, threads_));
  rz_ = 0;
  if (is_zero(x_)) {
    r_ = b_;
    r_norm_ = b_norm_;
  } else {
    refresh_residual(A);
  }
}

/// The residual of x as it is, and a new start of the search directions.
void ConjugateGradients::refresh_residual(const BlockMatrixd& A) {
  residual(A, b_, x_, r_, threads_);
  r_norm_ = std::sqrt(dot(r_, r_, threads_));
  rz_ = 0;
}

SolveStatus ConjugateGradients::iterate(const BlockMatrixd& A, const CgLimits& limits,
                                        const Preconditioner& preconditioner, int& iterations) {
  const double target = std::max(limits.tolerance * b_norm_, limits.absolute_tolerance);
  SolveStatus status = SolveStatus::Breakdown;
  double milestone = r_norm_;
  int milestone_iteration = 0;
  while (std::isfinite(r_norm_)) {
    if (r_norm_ <= target && judge_small_residual(A, target, status) == Verdict::Stop) return status;
    if (iterations >= limits.max_iterations) return SolveStatus::MaxIterations;
    const bool lost = step(A, limits, preconditioner) == Step::Lost;
    ++iterations;
    if (r_norm_ <= 0.5 * milestone) {
      milestone = r_norm_;
      milestone_iteration = iterations;
    }
    if (!lost && iterations - milestone_iteration < kStagnation) continue;
    if (recover(A, target, lost, preconditioner, status) == Verdict::Stop) return status;
    milestone = r_norm_;
    milestone_iteration = iterations;
  }
  return SolveStatus::Breakdown;
}

/// One iteration; x changes only if the numbers are those of a positive definite matrix and preconditioner.
ConjugateGradients::Step ConjugateGradients::step(const BlockMatrixd& A, const CgLimits& limits,
                                                  const Preconditioner& preconditioner) {
  const bool bare = limits.method == SolveMethod::Cycles;
  preconditioner.apply(r_, r_norm_, z_);
  const double rz = dot(z_, r_, threads_);
  if (!(rz > 0) || !std::isfinite(rz)) return Step::Lost;
  // r - r_old = -alpha q, so that r_old need not be kept.
  const double beta = !bare && rz_ > 0 ? -alpha_ * dot(z_, q_, threads_) / rz_ : 0.0;
  scale_and_add(beta, z_, p_, threads_);
  const double curvature = multiply_and_dot(A, p_, q_, threads_);
  if (!(curvature > 0) || !std::isfinite(curvature)) return Step::Lost;
  alpha_ = bare ? 1.0 : rz / curvature;
  rz_ = rz;
  add_scaled(alpha_, p_, x_, threads_);
  r_norm_ = std::sqrt(add_scaled_and_square(-alpha_, q_, r_, threads_));
  return Step::Taken;
}

/// The residual that is carried along drifts from b - A x by rounding; where that may matter the true one decides.
ConjugateGradients::Verdict ConjugateGradients::judge_small_residual(const BlockMatrixd& A, double target,
                                                                     SolveStatus& status) {
  const double drift = 4 * kEpsilon * largest_diagonal(A) * std::sqrt(dot(x_, x_, threads_));
  status = SolveStatus::Converged;
  if (drift < 0.1 * target) return Verdict::Stop;
  refresh_residual(A);
  if (r_norm_ <= target) return Verdict::Stop;
  status = SolveStatus::RoundOff;
  return r_norm_ <= rounding_floor(A) ? Verdict::Stop : Verdict::GoOn;
}

/// After a lost step or a long time without progress: done after all, or a better preconditioner, or a new start.
ConjugateGradients::Verdict ConjugateGradients::recover(const BlockMatrixd& A, double target, bool lost,
                                                        const Preconditioner& preconditioner, SolveStatus& status) {
  const bool fresh = rz_ == 0;
  const double rz = rz_;
  refresh_residual(A);
  status = SolveStatus::Breakdown;
  if (!std::isfinite(r_norm_)) return Verdict::Stop;
  if (r_norm_ <= target) return Verdict::GoOn;
  if (r_norm_ <= rounding_floor(A)) {
    status = SolveStatus::RoundOff;
    return Verdict::Stop;
  }
  if (preconditioner.improve()) return Verdict::GoOn;
  // Slow, but with no better preconditioner to be had: a new start would only lose what the directions know.
  if (!lost) rz_ = rz;
  return lost && fresh ? Verdict::Stop : Verdict::GoOn;
}

double ConjugateGradients::rounding_floor(const BlockMatrixd& A) const {
  return kRoundingUnits * kEpsilon * std::sqrt(absolute_product_square(A, b_, x_, threads_));
}

}  // namespace softreel
