/// Which energies are said to come from nothing.
#include "tool/report/energy_growth.h"

#include <cmath>

#include <gtest/gtest.h>

namespace softreel {
namespace {

template <typename Energy>
BodyEnergies history(int first, int last, const Energy& energy) {
  BodyEnergies body{"bar", {}};
  for (int frame = first; frame <= last; ++frame) body.frames[frame] = {energy(frame), ""};
  return body;
}

TEST(EnergyGrowth, IsOfMotionsThatBlowUp) {
  const auto growth = find_growth(history(1, 40,
                                          [](int f) {
                                            return FrameEnergy{std::exp(0.2 * f), 0.5 * std::exp(0.2 * f), 0};
                                          }),
                                  5);
  ASSERT_TRUE(growth.has_value());
  EXPECT_EQ(growth->first, 5);
  EXPECT_EQ(growth->last, 40);
  EXPECT_GT(growth->after, 10 * growth->before);
}

TEST(EnergyGrowth, IsNotOfWhatFallsSwingsOrDecays) {
  const auto falls = history(1, 40, [](int f) { return FrameEnergy{1.0 * f * f, 0, -1.0 * f * f}; });
  EXPECT_FALSE(find_growth(falls, 1)) << "gravity's energy became motion";
  const auto swings = history(1, 40, [](int f) {
    return FrameEnergy{3 * std::pow(std::sin(0.7 * f), 2), 3 * std::pow(std::cos(0.7 * f), 2) + 0.02 * f, 0};
  });
  EXPECT_FALSE(find_growth(swings, 1)) << "a quarter more is an integrator's own error";
  EXPECT_FALSE(find_growth(history(1, 40, [](int f) { return FrameEnergy{std::exp(-0.1 * f), 0, 0}; }), 1));
  EXPECT_FALSE(find_growth(history(1, 40, [](int) { return FrameEnergy{}; }), 1)) << "at rest";
}

TEST(EnergyGrowth, IsNotOfFramesInWhichSomethingWorks) {
  // Pulled until frame 20, then free.
  const auto pulled = history(1, 40, [](int f) { return FrameEnergy{0, 1.0 * std::min(f, 20), 0}; });
  EXPECT_FALSE(find_growth(pulled, 20));
  EXPECT_FALSE(find_growth(pulled, 38)) << "too few frames to tell";
}

}  // namespace
}  // namespace softreel
