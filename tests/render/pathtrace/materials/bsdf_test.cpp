#include "render/pathtrace/materials/bsdf.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/render/scattering_checks.h"

namespace softreel {
namespace {

struct Case {
  std::string name;
  Appearance appearance;
  bool inside = false;
};

Case make_case(std::string name, float roughness, float metallic, float specular, float transmission,
               bool inside = false) {
  Case c{std::move(name), {}, inside};
  c.appearance.base_color = Vec3f(0.9f, 0.5f, 0.2f);
  c.appearance.roughness = roughness;
  c.appearance.metallic = metallic;
  c.appearance.specular = specular;
  c.appearance.transmission = transmission;
  return c;
}

/// With layers over it.
Case covered(Case c, float coat, float coat_roughness, float sheen, float sheen_roughness) {
  c.name += " under layers";
  c.appearance.coat = coat;
  c.appearance.coat_roughness = coat_roughness;
  c.appearance.coat_color = Vec3f(0.9f, 0.6f, 0.3f);
  c.appearance.sheen = sheen;
  c.appearance.sheen_roughness = sheen_roughness;
  c.appearance.sheen_color = Vec3f(0.5f, 0.8f, 1.0f);
  return c;
}

Case subsurface_case(float share, bool inside) {
  Case c = make_case("subsurface", 0.4f, 0, 0.5f, 0, inside);
  c.appearance.subsurface = share;
  return c;
}

std::vector<Case> smooth_cases() {
  return {covered(make_case("diffuse", 0.5f, 0, 0, 0), 1, 0.4f, 0, 1),
          covered(make_case("dielectric", 0.5f, 0, 0.5f, 0), 0, 0, 1, 0.3f),
          covered(make_case("metal", 0.6f, 1, 0, 0), 0.7f, 0.5f, 0.8f, 0.6f),
          covered(make_case("glass", 0.6f, 0, 0.5f, 0.5f), 1, 0.4f, 0.5f, 0.2f),
          subsurface_case(0.6f, false),
          subsurface_case(0.6f, true),
          make_case("diffuse", 0.5f, 0, 0, 0),
          make_case("coated", 0.5f, 0, 0.5f, 0),
          make_case("glossy coat", 0.25f, 0, 1, 0),
          make_case("metal", 0.6f, 1, 0, 0),
          make_case("half metal", 0.4f, 0.5f, 1, 0),
          make_case("glass", 0.6f, 0, 0.5f, 1),
          make_case("glass from inside", 0.6f, 0, 0.5f, 1, true),
          make_case("all", 0.7f, 0.3f, 0.5f, 0.4f)};
}

TEST(Bsdf, DensityIntegratesToTheShareOfSamplesThatArrive) {
  for (const Case& c : smooth_cases()) {
    const Bsdf bsdf(c.appearance);
    const Vec3f o = direction(0.7f, 0.3f);
    const float integral =
        over_sphere([&](const Vec3f& i) { return Vec3f(Vec3f::Constant(bsdf.evaluate(o, i, c.inside).pdf)); }).x();
    const Sampler sampler(1, 2, 3);
    int arrived = 0;
    for (std::uint32_t s = 0; s < 4096; ++s) {
      const SampleBlock u = sampler.numbers(s, 0);
      BsdfSample sample;
      arrived += bsdf.sample(o, u[2], Vec2f(u[0], u[1]), c.inside, sample) && !sample.subsurface ? 1 : 0;
    }
    EXPECT_NEAR(integral, static_cast<float>(arrived) / 4096, 0.01f) << c.name;
    EXPECT_LE(integral, 1.005f) << c.name;
  }
}

TEST(Bsdf, SamplesCarryTheValueOverTheDensity) {
  for (const Case& c : smooth_cases()) {
    const Bsdf bsdf(c.appearance);
    const Sampler sampler(4, 5, 6);
    for (std::uint32_t s = 0; s < 512; ++s) {
      const SampleBlock u = sampler.numbers(s, 0);
      const Vec3f o = direction(0.1f + 1.4f * u[4], 1.0f);
      BsdfSample sample;
      if (!bsdf.sample(o, u[2], Vec2f(u[0], u[1]), c.inside, sample) || sample.subsurface) continue;
      ASSERT_FALSE(sample.mirror);
      const BsdfValue value = bsdf.evaluate(o, sample.direction, c.inside);
      EXPECT_NEAR(sample.direction.norm(), 1, 1e-5) << c.name;
      EXPECT_NEAR(sample.pdf, value.pdf, 1e-3f * value.pdf) << c.name;
      EXPECT_TRUE((sample.weight * sample.pdf).isApprox(value.value, 2e-3f)) << c.name;
    }
  }
}

TEST(Bsdf, EachLobeGetsPointsAsEvenAsAllAre) {
  // Every other lobe of this metal in paint is its cosine lobe: of n even points as many fall into each part of its
  // disk as belong there, but for those at the parts' edges. Were the lobe chosen by chance of its own, their number in
  // a half disk would be off by about sqrt(n) / 4.
  Appearance appearance = make_case("paint", 0.2f, 0.5f, 0, 0).appearance;
  appearance.base_color = appearance.metal_color.emplace(Vec3f::Constant(0.8f));
  const Bsdf bsdf(appearance);
  const BsdfView view = bsdf.seen_from(direction(0.6f, 0.3f), false);
  constexpr int kPoints = 4096;
  double squares = 0;
  constexpr int kPixels = 16;
  for (int pixel = 0; pixel < kPixels; ++pixel) {
    const Sampler sampler(1, pixel, 0);
    int left = 0;
    for (std::uint32_t s = 0; s < kPoints; ++s) {
      const SampleBlock u = sampler.numbers(s, 0);
      BsdfSample sample;
      if (bsdf.sample(view, u[2], Vec2f(u[0], u[1]), sample) && sample.wide && sample.direction.x() < 0) ++left;
    }
    squares += std::pow(left - 0.5 * static_cast<double>(view.shares.cosine) * kPoints, 2);
  }
  EXPECT_LT(std::sqrt(squares / kPixels), 0.25 * std::sqrt(kPoints) / 3);
}

TEST(Bsdf, SamplingGivesTheSameAlbedoAsIntegration) {
  for (const Case& c : smooth_cases()) {
    const Bsdf bsdf(c.appearance);
    const Vec3f o = direction(0.9f, 2.0f);
    const Vec3f integral = over_sphere([&](const Vec3f& i) { return bsdf.evaluate(o, i, c.inside).value; });
    const Sampler sampler(7, 8, 9);
    Vec3f mean = Vec3f::Zero();
    for (std::uint32_t s = 0; s < 4096; ++s) {
      const SampleBlock u = sampler.numbers(s, 0);
      BsdfSample sample;
      const bool found = bsdf.sample(o, u[2], Vec2f(u[0], u[1]), c.inside, sample);
      if (found && !sample.subsurface) mean += sample.weight / 4096;
    }
    EXPECT_LT((integral - mean).cwiseAbs().maxCoeff(), 0.012f) << c.name;
  }
}

TEST(Bsdf, IsReciprocal) {
  for (const Case& c : smooth_cases()) {
    if (c.appearance.transmission > 0) continue;
    const Bsdf bsdf(c.appearance);
    for (const float polar : {0.2f, 0.8f, 1.3f}) {
      const Vec3f o = direction(0.5f, 0.2f), i = direction(polar, 2.5f);
      // evaluate() includes the cosine of its second direction.
      const Vec3f there = bsdf.evaluate(o, i, c.inside).value / i.z(),
                  back = bsdf.evaluate(i, o, c.inside).value / o.z();
      EXPECT_TRUE(there.isApprox(back, 1e-3f)) << c.name << ": " << there.transpose() << " | " << back.transpose();
    }
  }
}

TEST(Bsdf, GlassIsReciprocalThroughTheSurface) {
  // f is for radiance over squared index: f(o, i) n_o^2 = f(i, o) n_i^2, seen from inside in a frame turned over.
  const Bsdf glass(make_case("glass", 0.3f, 0, 0, 1).appearance);
  const Vec3f o = direction(0.4f, 0.3f);
  for (const float polar : {2.8f, 2.9f}) {
    const Vec3f i = direction(polar, 3.2f);
    const Vec3f turned_o(o.x(), -o.y(), -o.z()), turned_i(i.x(), -i.y(), -i.z());
    const float there = glass.evaluate(o, i, false).value.x() / std::abs(i.z());
    const float back = glass.evaluate(turned_i, turned_o, true).value.x() / o.z();
    EXPECT_GT(there, 0);
    EXPECT_NEAR(there, back * 1.5f * 1.5f, 0.02f * there) << "up to the compensation of lost light";
  }
}

Vec3f furnace(const Appearance& appearance, float cosine, bool inside) {
  return sampled_albedo(Bsdf(appearance), direction(std::acos(cosine), 0.4f), inside);
}

TEST(Bsdf, WhiteSurfacesReflectAllLightAndNoMore) {
  // Coat and metal return what their facets lose; margin: the tables' interpolation.
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f})
    for (const float cosine : {0.1f, 0.4f, 0.7f, 1.0f})
      for (const float metallic : {0.0f, 0.5f, 1.0f})
        for (const float specular : {0.0f, 0.5f, 1.0f}) {
          Appearance white;
          white.base_color = Vec3f::Ones();
          white.roughness = roughness;
          white.metallic = metallic;
          white.specular = specular;
          const float albedo = furnace(white, cosine, false).x();
          EXPECT_NEAR(albedo, 1, 0.015) << "roughness " << roughness << " cosine " << cosine << " metallic " << metallic
                                        << " specular " << specular;
        }
}

TEST(Bsdf, GlassReflectsOrTransmitsAllLight) {
  for (const bool inside : {false, true})
    for (const float cosine : {0.1f, 0.5f, 1.0f})
      for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f}) {
        Appearance glass;
        glass.transmission = 1;
        glass.roughness = roughness;
        EXPECT_NEAR(furnace(glass, cosine, inside).x(), 1, 0.015) << roughness << ' ' << cosine << ' ' << inside;
      }
}

TEST(Bsdf, EvenLightInsideGlassNeitherGrowsNorFades) {
  // The mean over all directions, weighted by the cosine as light in a furnace comes; a thousandth at each of many hits
  // would be seen. Evaluated, not sampled: without noise.
  constexpr int kCosines = 24;
  for (const float ior : {1.5f, 2.4f})
    for (const bool inside : {false, true}) {
      Appearance glass;
      glass.transmission = 1;
      glass.specular = 0;
      glass.roughness = 1;
      glass.ior = ior;
      const Bsdf bsdf(glass);
      double sum = 0, weights = 0;
      for (int k = 0; k < kCosines; ++k) {
        const float cosine = (static_cast<float>(k) + 0.5f) / kCosines;
        const Vec3f o = direction(std::acos(cosine), 0.4f);
        const Vec3f albedo = over_sphere([&](const Vec3f& i) { return bsdf.evaluate(o, i, inside).value; });
        sum += static_cast<double>(cosine * albedo.x());
        weights += static_cast<double>(cosine);
      }
      EXPECT_NEAR(sum / weights, 1, 1.5e-3) << ior << (inside ? ", from inside" : "");
    }
}

TEST(Bsdf, GoldStaysBelowWhiteAndKeepsItsHue) {
  const Vec3f rough = furnace(make_case("gold", 0.9f, 1, 0, 0).appearance, 0.6f, false);
  EXPECT_LE(rough.maxCoeff(), 1.0f);
  EXPECT_GT(rough.x(), rough.y());
  EXPECT_GT(rough.y(), rough.z());
}

TEST(FresnelDielectric, AgreesWithItsLimits) {
  EXPECT_NEAR(fresnel_dielectric(1, 1.5f), 0.04, 1e-6);
  EXPECT_NEAR(fresnel_dielectric(1, 1 / 1.5f), 0.04, 1e-6);
  EXPECT_NEAR(fresnel_dielectric(1e-4f, 1.5f), 1, 1e-2);
  EXPECT_EQ(fresnel_dielectric(0.5f, 1 / 1.5f), 1) << "total internal reflection beyond 41.8 degrees";
  EXPECT_NEAR(fresnel_dielectric(std::cos(std::atan(1.5f)), 1.5f), 0.5 * std::pow(1.25 / 3.25, 2), 1e-5)
      << "Brewster's angle: only the light polarised across the plane is reflected";
}

TEST(Refract, ObeysSnell) {
  const Vec3f o = direction(0.8f, 0.5f);
  Vec3f i;
  ASSERT_TRUE(refract(o, Vec3f(0, 0, 1), 1.5f, i));
  EXPECT_NEAR(i.norm(), 1, 1e-6);
  EXPECT_NEAR(std::hypot(i.x(), i.y()) * 1.5, std::sin(0.8), 1e-6);
  EXPECT_LT(i.z(), 0);
  EXPECT_NEAR(o.x() * i.y() - o.y() * i.x(), 0, 1e-6) << "in the plane of incidence";
}

TEST(GgxDistribution, ProjectedAreaIsOne) {
  for (const float alpha : {0.3f, 0.6f, 1.0f})
    EXPECT_NEAR(over_sphere([&](const Vec3f& h) {
                  return Vec3f(Vec3f::Constant(h.z() > 0 ? ggx_distribution(h.z(), alpha) * h.z() : 0));
                }).x(),
                1, 2e-3);
}

TEST(GgxDistribution, VisibleNormalsProjectToTheViewersCosine) {
  // Heitz 2014, eq. (16): the visible area of the facets is that of the flat surface.
  const Vec3f o = direction(1.2f, 0.3f);
  const float area = over_sphere([&](const Vec3f& h) {
                       if (h.z() <= 0) return Vec3f(Vec3f::Zero());
                       const float d =
                           ggx_masking(o.z(), 0.5f) * std::max(0.0f, o.dot(h)) * ggx_distribution(h.z(), 0.5f);
                       return Vec3f(Vec3f::Constant(d));
                     }).x();
  EXPECT_NEAR(area, o.z(), 2e-3);
}

}  // namespace
}  // namespace softreel
