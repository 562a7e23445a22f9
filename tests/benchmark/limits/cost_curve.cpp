#include "tests/benchmark/limits/cost_curve.h"

#include <cmath>
#include <limits>

namespace softreel::bench {
namespace {

/// Value at x of the power law through two points.
double on_power_law(double x, double x0, double y0, double x1, double y1) {
  return y0 * std::exp(std::log(x / x0) * std::log(y1 / y0) / std::log(x1 / x0));
}

}  // namespace

double CostCurve::error_at(double cost) const {
  for (std::size_t i = 1; i < costs.size(); ++i)
    if (cost >= costs[i - 1] && cost <= costs[i])
      return on_power_law(cost, costs[i - 1], errors[i - 1], costs[i], errors[i]);
  return std::numeric_limits<double>::quiet_NaN();
}

double CostCurve::cost_for(double error, bool& extrapolated) const {
  extrapolated = false;
  if (costs.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::size_t last_above = costs.size();
  for (std::size_t i = 0; i < costs.size(); ++i)
    if (errors[i] > error) last_above = i;
  if (last_above == costs.size()) return costs.front();
  extrapolated = last_above + 1 == costs.size();
  const std::size_t k = extrapolated ? last_above : last_above + 1;
  if (k == 0 || errors[k] >= errors[k - 1]) return std::numeric_limits<double>::infinity();
  return on_power_law(error, errors[k - 1], costs[k - 1], errors[k], costs[k]);
}

}  // namespace softreel::bench
