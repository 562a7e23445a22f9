/// Error against cost of one method, and what it says between the points that were measured.
#pragma once

#include <vector>

namespace softreel::bench {

/// Points by rising cost; between them both are taken to be powers of each other.
struct CostCurve {
  std::vector<double> costs, errors;  ///< above 0

  /// NaN outside the range that was measured.
  double error_at(double cost) const;
  /// The least cost from which on the error stays at or below `error`. Beyond the dearest point, where `extrapolated`
  /// becomes true, by the slope of the last two; infinite if that does not fall.
  double cost_for(double error, bool& extrapolated) const;
};

}  // namespace softreel::bench
