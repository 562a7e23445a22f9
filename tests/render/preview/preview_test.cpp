#include "render/preview/preview.h"

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

TEST(NullPreview, DrawsTheColourOfTheHorizon) {
  const DisplayImage image = make_null_preview()->draw(scene_in_sky(1), 6, 4, ViewTransform::Standard, 0);
  EXPECT_EQ(image.width, 6);
  EXPECT_EQ(image.height, 4);
  EXPECT_EQ(image.pixels, std::vector<std::uint8_t>(72, 255));
}

}  // namespace
}  // namespace softreel
