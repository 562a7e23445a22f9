#include "tests/benchmark/scale/scale.h"

#include <cmath>

#include <gtest/gtest.h>

namespace softreel::bench {
namespace {

TEST(FitExponent, IsThatOfAPowerLaw) {
  std::vector<double> x, y;
  for (const double n : {1e3, 3e3, 2e4, 1e6}) {
    x.push_back(n);
    y.push_back(7e-6 * std::pow(n, 1.25));
  }
  EXPECT_NEAR(fit_exponent(x, y), 1.25, 1e-12);
}

TEST(FitExponent, IsNotMovedByErrorsThatDoNotGrow) {
  const std::vector<double> x{1, 10, 100, 1000}, y{2, 10, 100, 500};  // x, twice at one end and half at the other
  const double exponent = fit_exponent(x, y);
  EXPECT_LT(exponent, 1);
  EXPECT_GT(exponent, 1 - std::log10(4) / 3);
}

}  // namespace
}  // namespace softreel::bench
