/// Materials in drawn previews: what they let through, reflect and catch.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "render/pathtrace/materials/sheen.h"
#include "tests/render/preview/drawn_preview.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

class PreviewMaterial : public DrawnPreview {};

Appearance glowing(const Vec3f& color) {
  Appearance look = matte(0);
  look.emission = color;
  return look;
}

/// Glass that neither bends nor reflects.
Appearance clear_glass() {
  Appearance look = matte(1);
  look.transmission = 1;
  look.ior = 1;
  return look;
}

/// Seen from so far above that all rays are nearly parallel.
Scene before_black() {
  Scene scene = scene_in_sky(0);
  scene.camera = camera_above(60, 2.2f);
  return scene;
}

const Vec3f kGlow(0.8f, 0.4f, 0.2f);

TEST_F(PreviewMaterial, ClearGlassShowsWhatIsBehindItAndNotWhatIsBeforeItsBack) {
  Scene scene = before_black();
  // The order in the scene is not that of distance.
  scene.meshes = {square(0.3f, 0.5f, clear_glass()), square(1, 0, glowing(kGlow)),
                  square(0.2f, 1, glowing(Vec3f(0, 0, 1)))};
  const DisplayImage image = draw(scene);
  const auto at = [&](float x) { return pixel_of(image, scene.camera, Vec3f(x, 0, 0)); };
  EXPECT_LT((at(0.25f) - 255 * kGlow).cwiseAbs().maxCoeff(), 3) << at(0.25f).transpose();
  EXPECT_LT((at(0.6f) - 255 * kGlow).cwiseAbs().maxCoeff(), 3) << "beside the glass";
  EXPECT_LT((at(0.1f) - Vec3f(0, 0, 255)).cwiseAbs().maxCoeff(), 3) << "a body before the glass";
}

TEST_F(PreviewMaterial, AbsorptionGrowsWithTheWayThroughABall) {
  Scene scene = before_black();
  Appearance tinted = clear_glass();
  tinted.absorption = Vec3f(0, 2, 6);
  constexpr float kRadius = 0.4f;
  scene.meshes = {square(1, 0, glowing(Vec3f::Ones())), sphere(Vec3f(0, 0.6f, 0), kRadius, tinted, 48)};
  const DisplayImage image = draw(scene);
  for (const float x : {0.0f, 0.2f, 0.35f}) {
    const float way = 2 * std::sqrt(kRadius * kRadius - x * x);
    const Vec3f wanted = 255 * (-way * tinted.absorption).array().exp().matrix();
    const Vec3f seen = pixel_of(image, scene.camera, Vec3f(x, 0.6f, 0));
    EXPECT_LT((seen - wanted).cwiseAbs().maxCoeff(), 14)
        << x << ": " << seen.transpose() << " / " << wanted.transpose();
  }
}

TEST_F(PreviewMaterial, HalfTransparentBodiesAreHalfTheirColour) {
  Scene scene = before_black();
  Appearance half = clear_glass();
  half.transmission = 0.5f;
  half.base_color = Vec3f(0, 0.6f, 0);
  scene.environment.zenith = scene.environment.horizon = scene.environment.nadir = Vec3f::Constant(0.5f);
  scene.meshes = {square(1, 0, glowing(Vec3f(0.8f, 0, 0))), square(0.5f, 0.5f, half)};
  // Half of 0.8 from behind; half of 0.6 times the sky, which lights it.
  const Vec3f at = seen(scene, Vec3f(0.2f, 0.5f, 0));
  EXPECT_LT((at - 255 * Vec3f(0.4f, 0.15f, 0)).cwiseAbs().maxCoeff(), 4) << at.transpose();
}

TEST_F(PreviewMaterial, MetalHasItsOwnColourAndVarnishReflectsAtNormalIncidence) {
  Scene scene = scene_in_sky(1);
  scene.camera = camera_above(60, 2.2f);
  Appearance metal;
  metal.metallic = 1;
  metal.roughness = 0;
  metal.metal_color = Vec3f(0.9f, 0.5f, 0.2f);
  scene.meshes = {square(1, 0, metal)};
  EXPECT_LT((seen(scene, Vec3f::Zero()) - 255 * *metal.metal_color).cwiseAbs().maxCoeff(), 4);
  Appearance varnished = matte(0);
  varnished.coat = 1;
  varnished.coat_ior = 2;  // ((2 - 1) / (2 + 1))^2 = 1 / 9
  scene.meshes = {square(1, 0, varnished)};
  EXPECT_NEAR(seen(scene, Vec3f::Zero()).x(), 255.0f / 9, 3);
  varnished.base_color = Vec3f::Ones();  // 8 / 9 reach it and come back tinted
  varnished.coat_color = Vec3f(1, 0.5f, 1);
  scene.meshes = {square(1, 0, varnished)};
  EXPECT_NEAR(seen(scene, Vec3f::Zero()).x(), 255, 3);
  EXPECT_NEAR(seen(scene, Vec3f::Zero()).y(), 255 * (1.0f / 9 + 0.5f * 8 / 9), 5);
}

TEST_F(PreviewMaterial, FibresReflectAnEvenSkyAsThePathTracersDo) {
  Scene scene = scene_in_sky(1);
  scene.camera = camera_above(60, 2.2f);
  Appearance velvet = matte(0);
  velvet.roughness = 1;
  velvet.sheen = 1;
  velvet.sheen_color = Vec3f(1, 0.3f, 0.3f);
  for (const float roughness : {0.2f, 0.5f, 1.0f}) {
    const Sheen fibres(roughness);
    velvet.sheen_roughness = roughness;
    scene.meshes = {sphere(Vec3f::Zero(), 1, velvet, 48)};
    const DisplayImage image = draw(scene);
    for (const float x : {0.0f, 0.6f, 0.9f}) {
      const Vec3f at = pixel_of(image, scene.camera, Vec3f(x, 0, 0)) / 255;
      EXPECT_NEAR(at.x(), fibres.albedo(std::sqrt(1 - x * x)), 0.07f) << roughness << " " << x;
      EXPECT_NEAR(at.y(), 0.3f * at.x(), 0.01f) << x;
    }
  }
}

TEST_F(PreviewMaterial, FibresHaveNoHolesWhereTheyFaceTheCamera) {
  // From the middle of a ball all of it does: the cosines are 1 but for rounding, to either side.
  Scene scene = scene_in_sky(1);
  Appearance velvet = matte(0.5f);
  velvet.roughness = 1;
  velvet.sheen = 1;
  velvet.sheen_color = Vec3f::Ones();
  scene.meshes = {sphere(Vec3f(0.3f, 0.2f, 0.1f), 1, velvet, 48)};
  scene.camera.position = Vec3f(0.3f, 0.2f, 0.1f);
  scene.camera.target = Vec3f(-1, 0.5f, -2);
  const DisplayImage image = draw(scene);
  const auto [least, most] = std::minmax_element(image.pixels.begin(), image.pixels.end());
  EXPECT_GT(*least, 100);
  EXPECT_LE(*most - *least, 4);
}

TEST_F(PreviewMaterial, ACatcherLeavesTheShadowInTheAlphaAndNothingElse) {
  Scene scene = scene_in_sky(0);
  scene.ground.emplace();
  scene.ground->appearance = matte(0.5f);
  scene.ground->shadow_catcher = true;
  scene.meshes = {sphere(Vec3f(0, 1, 0), 0.3f, glowing(Vec3f(0.2f, 0.6f, 0.4f)))};
  scene.camera.position = Vec3f(0, 3, 4);
  scene.camera.target = Vec3f::Zero();
  scene.camera.focal_length_mm = 24;
  scene.suns.resize(1);
  scene.suns[0].direction = Vec3f(1, -1, 0).normalized();
  scene.suns[0].irradiance = Vec3f::Constant(2);
  const auto alpha_at = [&](const DisplayImage& image, const Vec3f& point) {
    const Vec2f at = place_of(point, scene.camera, kSize, kSize);
    return static_cast<int>(image.alpha[static_cast<std::size_t>(at.y()) * kSize + static_cast<std::size_t>(at.x())]);
  };
  const DisplayImage image = draw(scene);
  ASSERT_EQ(image.alpha.size(), static_cast<std::size_t>(kSize * kSize));
  EXPECT_EQ(alpha_at(image, Vec3f(1, 0, 0)), 255) << "all its light is hidden";
  EXPECT_EQ(pixel_of(image, scene.camera, Vec3f(1, 0, 0)), Vec3f::Zero());
  EXPECT_EQ(alpha_at(image, Vec3f(1, 0, 0.7f)), 0);
  EXPECT_EQ(alpha_at(image, Vec3f(0, 1, 0)), 255) << "the body";
  EXPECT_LT((pixel_of(image, scene.camera, Vec3f(0, 1, 0)) - 255 * Vec3f(0.2f, 0.6f, 0.4f)).cwiseAbs().maxCoeff(), 3);
  EXPECT_EQ(image.alpha.front(), 0) << "the surroundings";
  // Where the sky gives as much light as the sun, half of it is left: the sun's is 2 / sqrt(2) / pi, of a level ground.
  const float sky = 2 / std::sqrt(2.0f) / static_cast<float>(M_PI);
  scene.environment.zenith = scene.environment.horizon = scene.environment.nadir = Vec3f::Constant(sky);
  EXPECT_NEAR(alpha_at(draw(scene), Vec3f(1, 0, 0)), 127, 3);
}

TEST_F(PreviewMaterial, AnOutlineOverNothingKeepsItsColour) {
  Scene scene = scene_in_sky(0);
  scene.ground.emplace();
  scene.ground->shadow_catcher = true;
  scene.meshes = {sphere(Vec3f(0, 1, 0), 0.5f, glowing(Vec3f(0.2f, 0.6f, 0.4f)))};
  scene.camera.position = Vec3f(0, 1, 4);
  scene.camera.target = Vec3f(0, 1, 0);
  const DisplayImage image = draw(scene);
  int partly = 0;
  for (std::size_t k = 0; k < image.alpha.size(); ++k) {
    if (image.alpha[k] < 60 || image.alpha[k] == 255 || image.pixels[3 * k + 1] == 0) continue;
    ++partly;
    EXPECT_NEAR(image.pixels[3 * k + 1], 0.6f * 255, 4) << "not premultiplied";
  }
  EXPECT_GT(partly, 20);
}

}  // namespace
}  // namespace softreel
