/// Lights, the image of the sky and parts of the picture in drawn previews.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include <gtest/gtest.h>

#include "render/preview/preview_lights.h"
#include "render/scene/environment_radiance.h"
#include "tests/render/preview/drawn_preview.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

class PreviewSurroundings : public DrawnPreview {};

TEST_F(PreviewSurroundings, EveryLampThatThereIsRoomForLights) {
  Scene scene = scene_in_sky(0);
  scene.meshes = {square(1, 0, matte(0.5f))};
  scene.camera = camera_above(6, 1);
  AreaLight dark;
  dark.center = Vec3f(0, 3, 0);
  dark.u = Vec3f(0.5f, 0, 0);
  dark.v = Vec3f(0, 0, 0.5f);
  ASSERT_LT(dark.u.cross(dark.v).y(), 0) << "it shines down";
  AreaLight bright = dark;
  bright.radiance = Vec3f::Constant(10);
  dark.radiance = Vec3f::Zero();
  scene.area_lights.assign(kMaxPreviewLamps, dark);
  EXPECT_EQ(seen(scene, Vec3f::Zero()), Vec3f::Zero());
  for (const std::size_t k : {std::size_t{0}, std::size_t{8}, std::size_t{kMaxPreviewLamps - 1}}) {
    scene.area_lights.assign(kMaxPreviewLamps, dark);
    scene.area_lights[k] = bright;
    EXPECT_GT(seen(scene, Vec3f::Zero()).minCoeff(), 30) << "lamp " << k;
  }
}

/// Radiance 0.5 + 0.4 (along . d): the spherical harmonics of a preview know it without an error.
std::shared_ptr<const EnvironmentImage> brighter_along(const Vec3f& along) {
  auto image = std::make_shared<EnvironmentImage>();
  image->width = 256;
  image->height = 128;
  for (int y = 0; y < image->height; ++y)
    for (int x = 0; x < image->width; ++x) {
      const Vec2f at((static_cast<float>(x) + 0.5f) / 256, (static_cast<float>(y) + 0.5f) / 128);
      const float shade = along.dot(environment_direction(at, 0));
      image->pixels.emplace_back(0.5f + 0.4f * shade, 0.5f, 0.5f - 0.3f * shade);
    }
  return image;
}

TEST_F(PreviewSurroundings, TheImageOfTheSkyIsBehindAsThePathTracerSeesIt) {
  Scene scene = scene_in_sky(0);
  scene.environment.image = brighter_along(Vec3f(1, 0, 0));
  scene.environment.strength = 1.2f;
  scene.camera.focal_length_mm = 18;
  for (const float rotation : {0.0f, 1.0f, 3.0f}) {
    scene.environment.rotation = rotation;
    for (const Vec3f& target : {Vec3f(0, 0.5f, 0), Vec3f(0.5f, 3, 9)}) {
      scene.camera.target = target;
      const DisplayImage traced = to_display(rendered(scene, small_params(kSize, 16)), ViewTransform::Raw, 0);
      const DisplayImage drawn = draw(scene);
      int largest = 0;
      for (std::size_t k = 0; k < traced.pixels.size(); ++k)
        largest = std::max(largest, std::abs(traced.pixels[k] - drawn.pixels[k]));
      EXPECT_LE(largest, 3) << rotation << ", " << target.transpose();
    }
  }
}

TEST_F(PreviewSurroundings, TheImageOfTheSkyLightsAsItIsTurned) {
  Scene scene = scene_in_sky(0);
  scene.environment.image = brighter_along(Vec3f(1, 0, 0));
  scene.meshes = {sphere(Vec3f(0, 0.5f, 0), 0.5f, matte(0.8f), 48)};
  for (const float rotation : {0.0f, 1.0f, 3.0f}) {
    scene.environment.rotation = rotation;
    const DisplayImage traced = to_display(rendered(scene, small_params(kSize, 256)), ViewTransform::Raw, 0);
    const DisplayImage drawn = draw(scene);
    for (const Vec3f& side : {Vec3f(-0.35f, 0.5f, 0.35f), Vec3f(0, 0.5f, 0.5f), Vec3f(0.35f, 0.5f, 0.35f)}) {
      const Vec3f wanted = pixel_of(traced, scene.camera, side), found = pixel_of(drawn, scene.camera, side);
      EXPECT_LT((wanted - found).cwiseAbs().maxCoeff(), 8) << rotation << ", " << side.transpose();
    }
  }
}

TEST_F(PreviewSurroundings, AMirrorShowsTheImageOfTheSky) {
  Scene scene = scene_in_sky(0);
  scene.environment.image = brighter_along(Vec3f(0, 0, 1));
  Appearance mirror = matte(1);
  mirror.metallic = 1;
  mirror.roughness = 0.05f;
  scene.meshes = {square(1, 0, mirror)};
  scene.camera.position = Vec3f(0, 2, 2);  // its mirror image looks towards -z
  scene.camera.target = Vec3f::Zero();
  const float slope = std::sqrt(0.5f);
  EXPECT_NEAR(seen(scene, Vec3f::Zero()).x(), 255 * (0.5f - 0.4f * slope), 6);
  scene.environment.rotation = static_cast<float>(M_PI);
  EXPECT_NEAR(seen(scene, Vec3f::Zero()).x(), 255 * (0.5f + 0.4f * slope), 6);
}

class PreviewWindow : public ::testing::Test {
 protected:
  static constexpr int kWidth = 96, kHeight = 64;

  void SetUp() override {
    std::string reason;
    preview_ = egl_preview_or_null(reason);
    if (preview_ == nullptr) GTEST_SKIP() << reason;
    scene_ = scene_in_sky(0.2f);
    scene_.environment.zenith = Vec3f(0.1f, 0.2f, 0.9f);
    scene_.meshes = {sphere(Vec3f(0.4f, 0.6f, -0.3f), 0.5f, matte(0.6f))};
    scene_.ground.emplace();
    scene_.suns.resize(1);
    scene_.suns[0].direction = Vec3f(-1, -2, -1).normalized();
    style_.marks.dots = {{Vec3f(0.4f, 1.1f, -0.3f), Vec3f(1, 0.2f, 0.6f), 40}};
  }
  DisplayImage draw(int width, int height, const PixelWindow& window) {
    style_.window = window;
    return preview_->draw(scene_, width, height, ViewTransform::Standard, 0, style_);
  }
  /// Pixels of `part` that are not those of `whole`, `left` and `top` further on.
  static int differences(const DisplayImage& part, const DisplayImage& whole, int left, int top) {
    int count = 0;
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < part.width; ++x)
        count += (pixel_at(part, x, y) - pixel_at(whole, x + left, y + top)).cwiseAbs().maxCoeff() > 2 ? 1 : 0;
    return count;
  }

  std::unique_ptr<Preview> preview_;
  Scene scene_;
  PreviewStyle style_;
};

TEST_F(PreviewWindow, ACropIsAPartOfThePicture) {
  const DisplayImage whole = draw(kWidth, kHeight, {});
  const DisplayImage part = draw(kWidth, kHeight, {30, 10, 80, 50});
  ASSERT_EQ(part.width, 50);
  ASSERT_EQ(part.height, 40);
  // Outlines are rounded to a share of a pixel, which may take a sample from one side to the other.
  EXPECT_LT(differences(part, whole, 30, 10), 20);
}

TEST_F(PreviewWindow, OverscanGoesOnBeyondThePicture) {
  const DisplayImage whole = draw(kWidth, kHeight, {});
  const DisplayImage more = draw(kWidth, kHeight, {-10, -6, kWidth + 10, kHeight + 6});
  ASSERT_EQ(more.width, kWidth + 20);
  ASSERT_EQ(more.height, kHeight + 12);
  EXPECT_LT(differences(whole, more, 10, 6), 60);
  EXPECT_GT(differences(draw(kWidth, kHeight, {0, 0, kWidth, kHeight}), more, 0, 0), 200) << "it is moved";
}

TEST(NullPreview, HasTheSizeOfTheWindow) {
  PreviewStyle style;
  style.window = {-2, 0, 5, 4};
  const DisplayImage image = make_null_preview()->draw(scene_in_sky(1), 6, 4, ViewTransform::Standard, 0, style);
  EXPECT_EQ(image.width, 7);
  EXPECT_EQ(image.height, 4);
}

}  // namespace
}  // namespace softreel
