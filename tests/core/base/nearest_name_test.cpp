#include "core/base/nearest_name.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(NearestName, ForgivesATypingErrorAndCase) {
  const std::vector<std::string> known{"density", "damping", "poisson_ratio", "youngs_modulus"};
  EXPECT_EQ(nearest_name("poison_ratio", known), "poisson_ratio");
  EXPECT_EQ(nearest_name("Density", known), "density");
  EXPECT_EQ(nearest_name("dampnig", known), "damping");
  EXPECT_EQ(nearest_name("young_modulus", known), "youngs_modulus");
}

TEST(NearestName, IsEmptyWhereNothingIsNear) {
  EXPECT_EQ(nearest_name("colour", {"density", "damping"}), "");
  EXPECT_EQ(nearest_name("colour", {}), "");
  EXPECT_EQ(nearest_name("", {"density"}), "");
  EXPECT_EQ(nearest_name("x", {"yz"}), "");
}

TEST(NearestName, TakesTheFirstOfEquallyNearOnes) {
  EXPECT_EQ(nearest_name("pin", {"pen", "pan", "pins"}), "pen");
}

}  // namespace
}  // namespace softreel
