// Crops and overscan: other windows onto the same picture.
#include <gtest/gtest.h>

#include "render/pathtrace/path_tracer.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

Scene some_scene() {
  Scene scene = scene_in_sky(0.4f);
  scene.meshes = {square(3, 0, matte(0.6f)), sphere(Vec3f(0, 0.6f, 0), 0.5f, matte(0.3f))};
  scene.camera.position = Vec3f(1, 2, 4);
  scene.camera.f_number = 2;
  return scene;
}

RenderParams params(const PixelWindow& window) {
  RenderParams params = small_params(40, 4);
  params.height = 24;
  params.auxiliary = true;
  params.window = window;
  return params;
}

/// Expects what both show to be equal bits.
void expect_same_where_they_overlap(const Image& part, const Image& whole) {
  ASSERT_EQ(part.channels.size(), whole.channels.size());
  int compared = 0;
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) {
      const int u = x + part.left - whole.left, v = y + part.top - whole.top;
      if (u < 0 || u >= whole.width || v < 0 || v >= whole.height) continue;
      for (std::size_t c = 0; c < part.channels.size(); ++c)
        ASSERT_EQ(part.channels[c].pixels[static_cast<std::size_t>(y * part.width + x)],
                  whole.channels[c].pixels[static_cast<std::size_t>(v * whole.width + u)])
            << x << ", " << y;
      ++compared;
    }
  EXPECT_GT(compared, 0);
}

TEST(PixelWindow, ACropIsPartOfThePictureBitForBit) {
  const Image whole = rendered(some_scene(), params({}));
  EXPECT_EQ(whole.full_width, 0);
  for (const PixelWindow& window : {PixelWindow{13, 7, 32, 20}, PixelWindow{0, 0, 1, 1}, PixelWindow{0, 0, 40, 24}}) {
    const Image part = rendered(some_scene(), params(window));
    EXPECT_EQ(part.width, window.width());
    EXPECT_EQ(part.height, window.height());
    EXPECT_EQ(part.left, window.left);
    EXPECT_EQ(part.full_width, 40);
    EXPECT_EQ(part.full_height, 24);
    expect_same_where_they_overlap(part, whole);
  }
}

TEST(PixelWindow, OverscanGoesOnBeyondTheEdgesOfTheSamePicture) {
  const Image whole = rendered(some_scene(), params({}));
  const Image more = rendered(some_scene(), params({-5, -3, 45, 27}));
  EXPECT_EQ(more.width, 50);
  EXPECT_EQ(more.left, -5);
  expect_same_where_they_overlap(whole, more);
  // A wider lens on a wider sensor sees the same edge: the pixel grid is that of the picture.
  Scene wide = some_scene();
  wide.camera.sensor_width_mm *= 50.0f / 40;
  RenderParams larger = params({});
  larger.width = 50;
  larger.height = 30;
  larger.samples = 64;
  RenderParams overscanned = params({-5, -3, 45, 27});
  overscanned.samples = 64;
  const Image expected = rendered(wide, larger), found = rendered(some_scene(), overscanned);
  const Channel *a = expected.find("depth.Z"), *b = found.find("depth.Z");
  for (const std::size_t corner : {50u * 28 + 1, 50u * 28 + 48, 50u * 20 + 25})
    EXPECT_NEAR(a->pixels[corner], b->pixels[corner], 0.03 * static_cast<double>(a->pixels[corner]));
}

}  // namespace
}  // namespace softreel
