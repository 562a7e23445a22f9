// Coat and sheen over every base: no energy made, none of white lost, both directions equal.
#include <gtest/gtest.h>

#include "tests/render/scattering_checks.h"

namespace softreel {
namespace {

Appearance white() {
  Appearance appearance;
  appearance.base_color = Vec3f::Ones();
  return appearance;
}

TEST(TopLayers, WhiteUnderThemReturnsAllLight) {
  // Margin: interpolation of the tables, and 4096 samples of a lobe that is bright at the rim.
  for (const float coat : {0.0f, 0.5f, 1.0f})
    for (const float coat_roughness : {0.0f, 0.3f, 0.8f})
      for (const float sheen : {0.0f, 1.0f})
        for (const float metallic : {0.0f, 1.0f})
          for (const float subsurface : {0.0f, 1.0f}) {
            Appearance layered = white();
            layered.coat = coat;
            layered.coat_roughness = coat_roughness;
            layered.sheen = sheen;
            layered.sheen_roughness = 0.4f;
            layered.metallic = metallic;
            layered.subsurface = subsurface;
            const Bsdf bsdf(layered);
            for (const float cosine : {0.1f, 0.5f, 1.0f})
              EXPECT_NEAR(sampled_albedo(bsdf, direction(std::acos(cosine), 1), false).x(), 1, 0.02)
                  << coat << ' ' << coat_roughness << ' ' << sheen << ' ' << metallic << ' ' << subsurface << ' '
                  << cosine;
          }
}

TEST(TopLayers, CoveredGlassLetsThroughOrReturnsAllLight) {
  for (const bool inside : {false, true})
    for (const float roughness : {0.0f, 0.4f}) {
      Appearance glass = white();
      glass.transmission = 1;
      glass.roughness = roughness;
      glass.coat = 1;
      glass.sheen = 0.5f;
      for (const float cosine : {0.3f, 0.9f})
        EXPECT_NEAR(sampled_albedo(Bsdf(glass), direction(std::acos(cosine), 1), inside).x(), 1, 0.02)
            << inside << ' ' << roughness << ' ' << cosine;
    }
}

TEST(TopLayers, NeverReturnMoreThanArrives) {
  for (const float sheen_roughness : {0.1f, 0.3f, 1.0f})
    for (const float base_roughness : {0.1f, 0.9f}) {
      Appearance layered = white();
      layered.coat = 0.8f;
      layered.coat_roughness = 0.2f;
      layered.sheen = 1;
      layered.sheen_roughness = sheen_roughness;
      layered.roughness = base_roughness;
      layered.metallic = 0.5f;
      for (const float cosine : {0.02f, 0.05f, 0.2f, 0.6f})
        EXPECT_LE(sampled_albedo(Bsdf(layered), direction(std::acos(cosine), 1), false).x(), 1.02)
            << sheen_roughness << ' ' << base_roughness << ' ' << cosine;
    }
}

TEST(TopLayers, CoatReflectsByItsIndex) {
  // Over black: (n - 1)^2 / (n + 1)^2 head-on, all at the rim.
  Appearance varnish;
  varnish.base_color = Vec3f::Zero();
  varnish.specular = 0;
  varnish.coat = 1;
  varnish.coat_ior = 1.7f;
  EXPECT_NEAR(sampled_albedo(Bsdf(varnish), Vec3f(0, 0, 1), false).x(), std::pow(0.7 / 2.7, 2), 1e-4);
  EXPECT_GT(sampled_albedo(Bsdf(varnish), direction(std::acos(0.01f), 0), false).x(), 0.9f);
}

TEST(TopLayers, TintIsTheColourOfAMirrorBelow) {
  // A white mirror head-on: what the varnish lets through goes through its tint twice.
  Appearance mirror = white();
  mirror.metallic = 1;
  mirror.roughness = 0;
  mirror.coat = 1;
  mirror.coat_color = Vec3f(0.8f, 0.4f, 0.1f);
  const Vec3f seen = sampled_albedo(Bsdf(mirror), Vec3f(0, 0, 1), false);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], 0.04f + 0.96f * mirror.coat_color[c], 2e-3f);
  // A longer way through the varnish takes more: 1 / cos of the refracted ray.
  const Vec3f slanted = sampled_albedo(Bsdf(mirror), direction(std::acos(0.4f), 0), false);
  const float reflected = 0.04f + 0.96f * std::pow(0.6f, 5.0f), path = 1 / std::sqrt(1 - 0.84f / 2.25f);
  EXPECT_NEAR(slanted.y(), reflected + (1 - reflected) * std::pow(0.4f, path), 5e-3f);
}

TEST(Sheen, ReturnsLightAtTheRimOnly) {
  const Sheen fine(0.2f), coarse(1);
  EXPECT_LT(fine.albedo(1), 0.03f);
  EXPECT_GT(fine.albedo(0.05f), 0.5f);
  EXPECT_GT(coarse.albedo(1), 0.1f) << "rough fibres also shine head-on";
  for (const float roughness : {0.1f, 0.3f, 0.6f, 1.0f})
    for (float mu = 0; mu <= 1; mu += 0.02f) EXPECT_LE(Sheen(roughness).albedo(mu), 1);
}

TEST(Sheen, TableAgreesWithIntegration) {
  for (const float roughness : {0.1f, 0.5f, 1.0f}) {
    const Sheen sheen(roughness);
    for (const float cosine : {0.15f, 0.5f, 0.9f}) {
      const Vec3f o = direction(std::acos(cosine), 0.3f);
      const float integral = over_sphere([&](const Vec3f& i) { return Vec3f(Vec3f::Constant(sheen.value(o, i))); }).x();
      EXPECT_NEAR(sheen.albedo(cosine), integral, 5e-3f) << roughness << ' ' << cosine;
    }
  }
}

TEST(Sheen, IsReciprocal) {
  const Sheen sheen(0.4f);
  const Vec3f o = direction(0.3f, 0.1f), i = direction(1.4f, 2);
  EXPECT_NEAR(sheen.value(o, i) / i.z(), sheen.value(i, o) / o.z(), 1e-5f);
}

}  // namespace
}  // namespace softreel
