#include "tool/shot/shot.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(Origin, NamesFileLineAndColumn) {
  EXPECT_EQ(to_string(Origin{"a.toml", 3, 7}), "a.toml:3:7");
  EXPECT_EQ(to_string(Origin{"--set", 0, 0}), "--set");
}

}  // namespace
}  // namespace softreel
