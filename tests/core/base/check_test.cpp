#include "core/base/check.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(CheckDeathTest, PrintsBothOperands) {
  const int nodes = 3, expected = 4;
  EXPECT_DEATH(CHECK(nodes == expected), "nodes == expected.*3 == 4");
}

TEST(Check, PassesInSilence) {
  CHECK(1 < 2);
  CHECK(true);
}

}  // namespace
}  // namespace softreel
