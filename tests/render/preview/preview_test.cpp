#include "render/preview/preview.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// Null, with the reason printed, where this machine cannot draw.
std::unique_ptr<Preview> egl_preview_or_null(std::string& reason) {
  try {
    return make_egl_preview();
  } catch (const Error& error) {
    reason = error.what();
    return nullptr;
  }
}

/// A glowing ball before a black sky, off the centre, seen at an angle.
Scene glowing_ball() {
  Scene scene = scene_in_sky(0);
  Appearance glowing = matte(0);
  glowing.emission = Vec3f::Ones();
  scene.meshes = {sphere(Vec3f(0.4f, 0.6f, -0.3f), 0.5f, glowing)};
  scene.camera.position = Vec3f(1, 1.5f, 3);
  return scene;
}

TEST(NullPreview, DrawsTheColourOfTheHorizon) {
  const DisplayImage image = make_null_preview()->draw(scene_in_sky(1), 6, 4, ViewTransform::Standard, 0);
  EXPECT_EQ(image.width, 6);
  EXPECT_EQ(image.height, 4);
  EXPECT_EQ(image.pixels, std::vector<std::uint8_t>(72, 255));
}

TEST(EglPreview, SilhouettesCoincideWithThePathTracers) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  const Scene scene = glowing_ball();
  RenderParams params = small_params(64, 16);
  params.height = 48;
  const DisplayImage traced = to_display(rendered(scene, params), ViewTransform::Standard, 0);
  const DisplayImage drawn = preview->draw(scene, 64, 48, ViewTransform::Standard, 0);
  int covered = 0, different = 0;
  for (std::size_t k = 0; k < traced.pixels.size(); k += 3) {
    // Full pixels must be full and empty ones empty; a pixel of the outline may be either, and little of it is.
    const bool inside = traced.pixels[k] == 255, outside = traced.pixels[k] == 0;
    covered += inside ? 1 : 0;
    if ((inside && drawn.pixels[k] < 120) || (outside && drawn.pixels[k] > 140)) ++different;
  }
  EXPECT_GT(covered, 200);
  EXPECT_EQ(different, 0);
}

TEST(EglPreview, DrawsTheSkyAsThePathTracerSeesIt) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene;
  scene.environment.zenith = Vec3f(0.1f, 0.2f, 0.9f);
  scene.environment.horizon = Vec3f(3, 2, 1);
  const Image light = rendered(scene, small_params(32, 16));
  for (const ViewTransform view :
       {ViewTransform::Standard, ViewTransform::Filmic, ViewTransform::AcesFit, ViewTransform::Raw}) {
    const DisplayImage traced = to_display(light, view, -0.5f);
    const DisplayImage drawn = preview->draw(scene, 32, 32, view, -0.5f);
    for (std::size_t k = 0; k < traced.pixels.size(); ++k)
      EXPECT_NEAR(traced.pixels[k], drawn.pixels[k], 3) << static_cast<int>(view);
  }
}

TEST(EglPreview, IsLitFromTheSideOfTheLight) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = scene_in_sky(0.1f);
  scene.meshes = {sphere(Vec3f(0, 0.5f, 0), 0.5f, matte(0.8f))};
  scene.suns.resize(1);
  scene.suns[0].direction = Vec3f(-1, 0, 0);
  const DisplayImage image = preview->draw(scene, 40, 40, ViewTransform::Standard, 0);
  const auto at = [&](int x) { return static_cast<int>(image.pixels[static_cast<std::size_t>(3 * (40 * 20 + x))]); };
  EXPECT_GT(at(23), at(17) + 30);
}

TEST(EglPreview, DrawsTheSamePictureTwiceAndNamesItself) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = glowing_ball();
  scene.ground.emplace();
  scene.ground->style = GroundStyle::Sweep;
  scene.ground->checker = 0.5f;
  const auto draw = [&] { return preview->draw(scene, 33, 17, ViewTransform::Filmic, 0).pixels; };
  EXPECT_EQ(draw(), draw());
  EXPECT_NE(preview->description().find("EGL 1."), std::string::npos) << preview->description();
}

}  // namespace
}  // namespace softreel
