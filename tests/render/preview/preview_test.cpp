#include <cstdlib>

#include <gtest/gtest.h>

#include "render/scene/color_map.h"
#include "tests/render/preview/drawn_preview.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

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

TEST(EglPreview, DrawsABodyThatIsCloseBeforeAGroundOfKilometres) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = glowing_ball();
  scene.meshes = {sphere(Vec3f(0, 0, 0), 0.05f, scene.meshes[0].appearance)};
  scene.camera.position = Vec3f(0, 0.1f, 0.4f);
  scene.camera.target = Vec3f::Zero();
  scene.ground.emplace();
  scene.ground->height = -0.05f;
  scene.ground->size = 2000;
  const DisplayImage image = preview->draw(scene, 64, 64, ViewTransform::Raw, 0);
  EXPECT_GT(pixel_of(image, scene.camera, Vec3f::Zero()).minCoeff(), 250);
}

TEST(EglPreview, DrawsTheGroundRightBeforeALowCamera) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = glowing_ball();
  scene.camera.position = Vec3f(0, 0.05f, 4);
  scene.camera.target = Vec3f(0, 0.05f, 0);
  scene.ground.emplace();
  scene.ground->size = 1000;
  scene.ground->appearance = scene.meshes[0].appearance;
  const DisplayImage image = preview->draw(scene, 64, 64, ViewTransform::Raw, 0);
  for (const int y : {40, 50, 63}) EXPECT_GT(pixel_at(image, 2, y).minCoeff(), 250) << y;
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

TEST(EglPreview, SidesOfACubeWithHardEdgesAreEvenlyLit) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = scene_in_sky(0.2f);
  scene.meshes = {hard_cube(0.5f, matte(0.8f))};
  scene.suns.resize(1);
  scene.suns[0].direction = Vec3f(-1, -3, -2).normalized();
  scene.camera.position = Vec3f(2, 2, 2);
  scene.camera.target = Vec3f(0, 0, 0);
  const DisplayImage image = preview->draw(scene, 96, 96, ViewTransform::Raw, 0);
  const std::array<Vec3f, 3> sides{Vec3f(0.5f, 0, 0), Vec3f(0, 0.5f, 0), Vec3f(0, 0, 0.5f)};
  std::array<Vec3f, 3> middles;
  for (std::size_t s = 0; s < 3; ++s) {
    middles[s] = pixel_of(image, scene.camera, sides[s]);
    for (const float to : {-0.4f, 0.4f}) {
      const Vec3f near_edges = sides[s] + to * (Vec3f(1, 1, 1) - 2 * sides[s]);
      EXPECT_LE((pixel_of(image, scene.camera, near_edges) - middles[s]).cwiseAbs().maxCoeff(), 1) << s;
    }
  }
  for (std::size_t s = 0; s < 3; ++s) EXPECT_GT((middles[s] - middles[(s + 1) % 3]).norm(), 10) << "each by its normal";
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

TEST(EglPreview, FastAndShadowedPicturesHaveTheSameSilhouette) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  const Scene scene = glowing_ball();
  const DisplayImage fine = preview->draw(scene, 64, 48, ViewTransform::Standard, 0);
  PreviewStyle style;
  style.fast = true;
  const DisplayImage fast = preview->draw(scene, 64, 48, ViewTransform::Standard, 0, style);
  int covered = 0, partly = 0;
  for (std::size_t k = 0; k < fine.pixels.size(); k += 3) {
    EXPECT_TRUE(fast.pixels[k] == 0 || fast.pixels[k] == 255) << "fast pixels are covered or not";
    const bool whole = fine.pixels[k] == 255;
    covered += whole ? 1 : 0;
    const bool outline = !whole && fine.pixels[k] != 0;
    partly += outline ? 1 : 0;
    if (!outline) {
      EXPECT_EQ(fast.pixels[k], fine.pixels[k]) << k;
    }
  }
  EXPECT_GT(covered, 200);
  EXPECT_GT(partly, 20) << "the outline is anti-aliased";
}

TEST(EglPreview, HeatHasTheColoursOfTheMap) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  for (const float value : {0.0f, 0.3f, 0.8f}) {
    // Lit by a white sky from everywhere, a matt surface shows its own colour.
    Scene scene = scene_in_sky(1);
    scene.meshes = {sphere(Vec3f(0, 0.5f, 0), 0.5f, matte(0.9f))};
    scene.camera.target = Vec3f(0, 0.5f, 0);
    scene.camera.position = Vec3f(0, 0.5f, 4);
    scene.meshes[0].coloring.heat.assign(scene.meshes[0].times[0].positions.size(), value);
    const Vec3f color = pixel_at(preview->draw(scene, 33, 33, ViewTransform::Standard, 0), 16, 16);
    EXPECT_LT((color - 255 * heat_code(value)).cwiseAbs().maxCoeff(), 6) << value << ": " << color.transpose();
  }
}

TEST(EglPreview, VertexColoursAreInterpolated) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = scene_in_sky(1);
  scene.meshes = {square(1, 0, matte(0.9f))};
  scene.meshes[0].coloring.colors = {Vec3f(1, 0, 0), Vec3f(0, 0, 1), Vec3f(0, 0, 1),
                                     Vec3f(1, 0, 0)};  // red to the left
  scene.camera.position = Vec3f(0, 4, 0.01f);
  scene.camera.target = Vec3f::Zero();
  const DisplayImage image = preview->draw(scene, 41, 41, ViewTransform::Raw, 0);
  const auto along = [&](float x) {
    const Vec2f at = place_of(Vec3f(x, 0, 0.2f), scene.camera, 41, 41);
    return pixel_at(image, static_cast<int>(at.x()), static_cast<int>(at.y()));
  };
  for (const float x : {-0.8f, -0.3f, 0.0f, 0.5f}) {
    const Vec3f expected = 255 * Vec3f(0.5f * (1 - x), 0, 0.5f * (1 + x));
    EXPECT_LT((along(x) - expected).cwiseAbs().maxCoeff(), 16) << x << ": " << along(x).transpose();
  }
}

TEST(EglPreview, DotsAppearWhereTheCameraProjectsThemAndFainterBehindBodies) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = glowing_ball();
  scene.meshes[0].appearance.emission = Vec3f::Zero();  // black before black
  const Vec3f center(0.4f, 0.6f, -0.3f), toward = (scene.camera.position - center).normalized();
  const Vec3f seen = center + 0.5f * toward, hidden = center - 0.5f * toward + Vec3f(0.1f, 0.12f, 0);
  const Vec3f beside(-0.4f, 0.2f, 0.3f);
  PreviewStyle style;
  style.marks.dots = {{seen, Vec3f(1, 0, 0), 10}, {hidden, Vec3f(0, 1, 0), 10}, {beside, Vec3f(0, 0, 1), 10}};
  constexpr int kWidth = 640, kHeight = 480;
  const DisplayImage image = preview->draw(scene, kWidth, kHeight, ViewTransform::Standard, 0, style);
  const auto at = [&](const Vec3f& point, int right, int down) {
    const Vec2f place = place_of(point, scene.camera, kWidth, kHeight);
    return pixel_at(image, static_cast<int>(place.x()) + right, static_cast<int>(place.y()) + down);
  };
  EXPECT_EQ(at(seen, 0, 0), Vec3f(255, 0, 0));
  EXPECT_EQ(at(beside, 0, 0), Vec3f(0, 0, 255));
  EXPECT_NEAR(at(hidden, 0, 0).y(), 0.25f * 255, 8);
  for (const Vec3f& point : {seen, hidden, beside})
    for (const auto& [right, down] : {std::pair(6, 0), std::pair(-6, 0), std::pair(0, 6), std::pair(0, -6)})
      EXPECT_LT(at(point, right, down).maxCoeff(), 30) << "a dot is 10 / 720 of the height wide";
}

TEST(EglPreview, LinesReachFromEndToEndAndAreCutBehindTheCamera) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = scene_in_sky(0);
  const Vec3f from(-0.5f, 0.2f, 0), to(0.6f, 0.9f, -0.5f);
  const Vec3f behind = scene.camera.position + 2 * (scene.camera.position - from) + Vec3f(0.3f, 0, 0);
  PreviewStyle style;
  style.marks.lines = {{from, to, Vec3f(0, 1, 0)}};
  constexpr int kSize = 200;
  const auto share_on = [&](const Vec3f& a, const Vec3f& b, float first, float last) {
    const DisplayImage image = preview->draw(scene, kSize, kSize, ViewTransform::Standard, 0, style);
    int on = 0;
    for (int k = 0; k < 50; ++k) {
      const float t = first + (last - first) * (static_cast<float>(k) + 0.5f) / 50;
      const Vec2f at = place_of(a + t * (b - a), scene.camera, kSize, kSize);
      if (pixel_at(image, static_cast<int>(at.x()), static_cast<int>(at.y())).y() > 60) ++on;
    }
    return on;
  };
  EXPECT_GE(share_on(from, to, 0, 1), 48);
  EXPECT_EQ(share_on(from, to, 1.1f, 1.3f), 0);
  style.marks.lines = {{from, behind, Vec3f(0, 1, 0)}};
  EXPECT_GE(share_on(from, behind, 0, 0.1f), 48);
}

TEST(EglPreview, ABodyCastsAShadowWhereTheLightIsHidden) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = scene_in_sky(0);
  scene.ground.emplace();
  scene.ground->appearance = matte(0.5f);
  scene.meshes = {sphere(Vec3f(0, 1, 0), 0.3f, matte(0.5f))};
  scene.camera.position = Vec3f(0, 3, 4);
  scene.camera.target = Vec3f(0, 0, 0);
  scene.camera.focal_length_mm = 24;
  constexpr int kSize = 128;
  const auto brightness = [&](const Vec3f& point, bool fast) {
    PreviewStyle style;
    style.fast = fast;
    const DisplayImage image = preview->draw(scene, kSize, kSize, ViewTransform::Standard, 0, style);
    const Vec2f at = place_of(point, scene.camera, kSize, kSize);
    return pixel_at(image, static_cast<int>(at.x()), static_cast<int>(at.y())).x();
  };
  const auto expect_shadow_at = [&](const Vec3f& shadow, const Vec3f& side) {
    EXPECT_EQ(brightness(shadow, false), 0);
    EXPECT_GT(brightness(shadow, true), 60) << "the fast mode knows no shadows";
    for (const float sign : {-1.0f, 1.0f}) EXPECT_GT(brightness(shadow + sign * side, false), 60);
  };
  scene.suns.resize(1);
  scene.suns[0].direction = Vec3f(1, -1, 0).normalized();
  scene.suns[0].irradiance = Vec3f::Constant(2);
  expect_shadow_at(Vec3f(1, 0, 0), Vec3f(0, 0, 0.6f));
  scene.suns.clear();
  // A small lamp at (1, 3, 0): rays through the ball's centre meet the ground at (-0.5, 0, 0).
  scene.area_lights.resize(1);
  AreaLight& lamp = scene.area_lights[0];
  lamp.center = Vec3f(1, 3, 0);
  lamp.u = Vec3f(0.05f, 0, 0);
  lamp.v = Vec3f(0, 0, 0.05f);
  lamp.radiance = Vec3f::Constant(3000);
  if (lamp.u.cross(lamp.v).y() > 0) std::swap(lamp.u, lamp.v);  // it shines downwards
  expect_shadow_at(Vec3f(-0.5f, 0, 0), Vec3f(0, 0, 0.8f));
}

TEST(EglPreview, WireframeDarkensEdgesAndLeavesTheRest) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  Scene scene = scene_in_sky(0);
  Appearance glowing = matte(0);
  glowing.emission = Vec3f::Ones();
  scene.meshes = {square(1, 0, glowing)};
  scene.camera.position = Vec3f(0, 4, 0.01f);
  scene.camera.target = Vec3f::Zero();
  PreviewStyle style;
  style.wireframe = true;
  style.fast = true;
  const DisplayImage image = preview->draw(scene, 101, 101, ViewTransform::Raw, 0, style);
  const auto at = [&](float x, float z) {
    const Vec2f place = place_of(Vec3f(x, 0, z), scene.camera, 101, 101);
    return pixel_at(image, static_cast<int>(place.x()), static_cast<int>(place.y())).x();
  };
  // The diagonal of the square runs from (-1, 1) to (1, -1).
  int on_diagonal = 0;
  for (int k = -8; k <= 8; ++k) {
    const float t = 0.1f * static_cast<float>(k);
    float darkest = 255;
    for (const float aside : {-0.03f, 0.0f, 0.03f}) darkest = std::min(darkest, at(t + aside, -t));
    on_diagonal += darkest < 240 ? 1 : 0;
    EXPECT_EQ(at(0.5f, 0.3f), 255);
    EXPECT_EQ(at(-0.5f, -0.3f), 255);
  }
  EXPECT_GE(on_diagonal, 16);
}

TEST(EglPreview, FineTrianglesLookAsCoarseOnesDo) {
  std::string reason;
  const std::unique_ptr<Preview> preview = egl_preview_or_null(reason);
  if (preview == nullptr) GTEST_SKIP() << reason;
  const auto draw = [&](int rows) {
    Scene scene = scene_in_sky(0.2f);
    Appearance skin = matte(0.5f);
    skin.roughness = 0.5f;
    scene.meshes = {sphere(Vec3f(0, 0.5f, 0), 0.5f, skin, rows)};
    scene.camera.position = Vec3f(0.5f, 1, 3);
    scene.camera.target = Vec3f(0, 0.5f, 0);
    scene.suns.resize(1);
    scene.suns[0].direction = Vec3f(-1, -0.4f, -1).normalized();
    scene.suns[0].irradiance = Vec3f::Constant(3);
    return preview->draw(scene, 320, 240, ViewTransform::Standard, 0);
  };
  // Triangles of about 11 pixels, lit at pixels; and of about 1.6 pixels, lit at vertices.
  const DisplayImage coarse = draw(24), fine = draw(160);
  double sum = 0;
  int body = 0;
  for (std::size_t k = 0; k < fine.pixels.size(); k += 3) {
    const int difference = std::abs(fine.pixels[k] - coarse.pixels[k]);
    sum += difference;
    body += fine.pixels[k] > 140 ? 1 : 0;
  }
  EXPECT_GT(body, 2000) << "the sun lights it";
  EXPECT_LT(sum / (320 * 240), 1);
}

}  // namespace
}  // namespace softreel
