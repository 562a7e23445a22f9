#include "core/base/check.h"

#include <ostream>

#include <gtest/gtest.h>

namespace softreel {
namespace {

/// Counts how often it is printed.
struct Counted {
  int value = 0;
  int* printed = nullptr;

  explicit operator bool() const { return value != 0; }
  bool operator==(const Counted& other) const { return value == other.value; }
};

std::ostream& operator<<(std::ostream& out, const Counted& counted) {
  ++*counted.printed;
  return out << counted.value;
}

TEST(CheckDeathTest, PrintsBothOperands) {
  const int nodes = 3, expected = 4;
  EXPECT_DEATH(CHECK(nodes == expected), "nodes == expected.*3 == 4");
}

TEST(Check, PassesInSilence) {
  CHECK(1 < 2);
  CHECK(true);
}

TEST(Check, PrintsNoOperandUnlessItFailed) {
  int printed = 0;
  const Counted one{1, &printed}, zero{0, &printed};
  CHECK(one);
  CHECK(one == one);
  EXPECT_EQ(printed, 0);
  EXPECT_EQ(detail::check_result(detail::CheckStart{} << zero).operands, "0");
  EXPECT_EQ(printed, 1);
}

}  // namespace
}  // namespace softreel
