#include "tool/batch/energy_plot.h"

#include <cmath>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

namespace softreel {
namespace {

/// y of the points of one line of a plot, by x.
std::map<double, double> points(const std::string& svg, const std::string& name) {
  const std::string head = "plot-line plot-" + name + "\" points=\"";
  const std::size_t at = svg.find(head);
  EXPECT_NE(at, std::string::npos) << name;
  std::istringstream in(svg.substr(at + head.size(), svg.find('"', at + head.size()) - at - head.size()));
  std::map<double, double> found;
  char comma = 0;
  for (double x = 0, y = 0; in >> x >> comma >> y;) found[x] = y;
  return found;
}

TEST(EnergyPlot, LinesFollowTheNumbersUpwardAndTheTotalIsTheirSum) {
  BodyEnergies body{"a", {}};
  for (int frame = 1; frame <= 11; ++frame) {
    const double t = 0.1 * (frame - 1);
    body.frames[frame] = {{t * t, 1 - t, -0.5 * t}, ""};
  }
  const std::string svg = energy_plot({body});
  const auto kinetic = points(svg, "kinetic"), elastic = points(svg, "elastic"), gravity = points(svg, "gravity"),
             total = points(svg, "total");
  ASSERT_EQ(kinetic.size(), 11U);
  const double zero = kinetic.begin()->second;  // no kinetic energy at the first frame
  const double one = elastic.begin()->second;   // elastic energy 1 there
  EXPECT_LT(one, zero) << "up is more";
  int k = 0;
  for (const auto& [x, y] : kinetic) {
    const double t = 0.1 * k++;
    EXPECT_NEAR((zero - y) / (zero - one), t * t, 0.002);
    EXPECT_NEAR((zero - total.at(x)) / (zero - one), t * t + 1 - t - 0.5 * t, 0.002);
    EXPECT_NEAR((zero - gravity.at(x)) / (zero - one), -0.5 * t, 0.002);
  }
}

TEST(EnergyPlot, AddsBodiesWhereAllAreKnownAndIsEmptyForOneFrame) {
  BodyEnergies a{"a", {}}, b{"b", {}};
  for (int frame = 1; frame <= 5; ++frame) a.frames[frame] = {{1, 2, 3}, ""};
  EXPECT_TRUE(energy_plot({}).empty());
  EXPECT_TRUE(energy_plot({a, b}).empty());
  b.frames[3] = {{1, 1, 1}, ""};
  EXPECT_TRUE(energy_plot({a, b}).empty());
  b.frames[4] = b.frames[5] = {{1, 1, 1}, ""};
  EXPECT_EQ(points(energy_plot({a, b}), "total").size(), 3U);
}

TEST(EnergyPlot, ABodyThatNeverMovesHasALineToo) {
  BodyEnergies body{"still", {}};
  for (int frame = 1; frame <= 3; ++frame) body.frames[frame] = {};
  const std::string svg = energy_plot({body});
  EXPECT_EQ(points(svg, "total").size(), 3U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(RoundSteps, AreFewEqualRoundAndWithinTheirBounds) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const double size = std::pow(10, std::uniform_real_distribution(-9.0, 9.0)(random));
    const double low = size * std::uniform_real_distribution(-1.0, 1.0)(random), high = low + size;
    const std::vector<double> values = round_steps(low, high, 4);
    ASSERT_GE(values.size(), 1U);
    ASSERT_LE(values.size(), 5U);
    for (std::size_t k = 0; k < values.size(); ++k) {
      EXPECT_GE(values[k], low - 1e-9 * size);
      EXPECT_LE(values[k], high + 1e-9 * size);
      if (k == 0) continue;
      const double step = values[k] - values[k - 1];
      const double leading = step / std::pow(10, std::floor(std::log10(step) + 1e-6));
      EXPECT_TRUE(std::abs(leading - 1) < 1e-6 || std::abs(leading - 2) < 1e-6 || std::abs(leading - 5) < 1e-6) << step;
    }
  }
}

}  // namespace
}  // namespace softreel
