#include "core/multigrid/float_solver.h"

#include <cmath>
#include <vector>

namespace softreel {
namespace {

/// Iterations that must at least halve the residual; a sound cycle needs two or three.
constexpr int kFloatStagnation = 12;

/// Of a guess's energy, what must be new to the direction before; less is rounding.
constexpr double kLeastGuess = 1e-5;

using Lanes = NodeLanes<float>;

/// A sum of products of lanes in double; the fourth lane counts for nothing.
struct Sum {
  Eigen::Array4d lanes = Eigen::Array4d::Zero();
  void add(const Lanes& a, const Lanes& b) { lanes += (a * b).cast<double>(); }
  double value() const { return lanes[0] + lanes[1] + lanes[2]; }
};

}  // namespace

/// z . r, z . q and z . A z with A z = r - residual of z.
FloatSolver::Dots FloatSolver::find_dots(const Proposal& proposal) const {
  const NodeVector<float>&z = proposal.z, &r = cycle_.right_side();
  const auto nodes = static_cast<std::int64_t>(z.size() / 4);
  std::vector<Dots> parts(static_cast<std::size_t>((nodes + kRowGrain - 1) / kRowGrain));
  threads_.for_chunks(nodes, kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    Sum zr, zq, zAz;
    for (std::int64_t i = begin; i < end; ++i) {
      const Lanes z_i = lanes(z, i), r_i = lanes(r, i);
      zr.add(z_i, r_i);
      zq.add(z_i, lanes(q_, i));
      zAz.add(z_i, r_i - lanes(proposal.residual, i));
    }
    parts[static_cast<std::size_t>(begin / kRowGrain)] = {zr.value(), zq.value(), zAz.value()};
  });
  Dots dots;
  for (const Dots& part : parts) {
    dots.zr += part.zr;
    dots.zq += part.zq;
    dots.zAz += part.zAz;
  }
  return dots;
}

/// p = z + beta p, q = A z + beta q, x += alpha p, r -= alpha q; returns r . r.
double FloatSolver::advance(const Proposal& proposal, float beta, float alpha) {
  NodeVector<float>& r = cycle_.right_side();
  const auto nodes = static_cast<std::int64_t>(r.size() / 4);
  return threads_.sum_chunks(nodes, kRowGrain, [&](std::int64_t begin, std::int64_t end) {
    Sum rr;
    for (std::int64_t i = begin; i < end; ++i) {
      const Lanes p = lanes(proposal.z, i) + beta * lanes(p_, i);
      const Lanes q = lanes(r, i) - lanes(proposal.residual, i) + beta * lanes(q_, i);
      lanes(p_, i) = p;
      lanes(q_, i) = q;
      lanes(x_, i) += alpha * p;
      const Lanes next = lanes(r, i) - alpha * q;
      lanes(r, i) = next;
      rr.add(next, next);
    }
    return rr.value();
  });
}

/// Takes the best multiple of the guess, made conjugate to the direction before; leaves all as it was if the guess has
/// nothing to give.
void FloatSolver::search(const NodeVector<float>& guess, double target, SolveReport& report) {
  const Proposal proposal{guess, cycle_.find_residual_of(guess)};
  const Dots dots = find_dots(proposal);
  const double beta = pq_ > 0 ? -dots.zq / pq_ : 0.0, pq = dots.zAz + beta * dots.zq;
  if (!(pq > kLeastGuess * dots.zAz) || !std::isfinite(dots.zr / pq)) return;
  const double rr = advance(proposal, static_cast<float>(beta), static_cast<float>(dots.zr / pq));
  pq_ = pq;
  report.residual = std::sqrt(rr);
  if (report.residual <= target) report.status = SolveStatus::Converged;
}

SolveReport FloatSolver::solve(double target, int max_iterations, SolveMethod method,
                               std::span<const NodeVector<float>> guesses) {
  const bool bare = method == SolveMethod::Cycles;
  const std::size_t size = cycle_.right_side().size();
  for (NodeVector<float>* vector : {&x_, &p_, &q_}) vector->assign(size, 0.0F);
  pq_ = 0;
  SolveReport report{SolveStatus::Breakdown, 0, 1, false};
  for (const NodeVector<float>& guess : guesses) search(guess, target, report);
  if (report.ok()) return report;
  double milestone = 0;
  int milestone_iteration = 0;
  while (report.iterations < max_iterations) {
    cycle_.run();
    const Proposal proposal{cycle_.result(), cycle_.find_residual_of_result()};
    const Dots dots = find_dots(proposal);
    // Flexible: beta = z . (r - r_old) / (z_old . r_old) with r - r_old = -alpha q and alpha = z_old . r_old / (p . q).
    // Then p_new . q_new = z . A z - (z . q)^2 / (p . q), without another sum.
    const double beta = !bare && pq_ > 0 ? -dots.zq / pq_ : 0.0;
    const double pq = dots.zAz + beta * dots.zq;
    if (!(dots.zr > 0) || !(pq > 0) || !std::isfinite(dots.zr) || !std::isfinite(pq)) return report;
    const double alpha = bare ? 1.0 : dots.zr / pq;
    const double rr = advance(proposal, static_cast<float>(beta), static_cast<float>(alpha));
    pq_ = pq;
    ++report.iterations;
    report.residual = std::sqrt(rr);
    if (report.residual <= target) {
      report.status = SolveStatus::Converged;
      return report;
    }
    if (milestone_iteration == 0 || report.residual <= 0.5 * milestone) {
      milestone = report.residual;
      milestone_iteration = report.iterations;
    }
    if (report.iterations - milestone_iteration >= kFloatStagnation || !std::isfinite(rr)) return report;
  }
  report.status = SolveStatus::MaxIterations;
  return report;
}

}  // namespace softreel
