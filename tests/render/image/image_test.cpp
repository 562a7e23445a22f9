#include "render/image/image.h"

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(Image, FindsChannelsByName) {
  const Image image{1, 1, {{"R", {1.0f}}, {"depth.Z", {2.0f}}}};
  ASSERT_NE(image.find("depth.Z"), nullptr);
  EXPECT_EQ(image.find("depth.Z")->pixels.front(), 2.0f);
  EXPECT_EQ(image.find("depth"), nullptr);
}

}  // namespace
}  // namespace softreel
