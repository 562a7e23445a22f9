#include "render/pathtrace/materials/albedo_cache.h"

#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

Appearance layered(float roughness) {
  Appearance appearance;
  appearance.roughness = roughness;
  appearance.transmission = 0.5f;
  appearance.coat = 0.7f;
  appearance.coat_roughness = 0.2f;
  appearance.sheen = 0.4f;
  return appearance;
}

void expect_same(const AlbedoTable& a, const AlbedoTable& b) {
  for (float mu = 0; mu <= 1; mu += 0.05f) EXPECT_EQ(a.at(mu), b.at(mu));
  EXPECT_EQ(a.mean(), b.mean());
}

/// Of what an appearance fills.
void expect_tables_of(const Appearance& appearance, const AlbedoTables& a) {
  const AlbedoTables b = AlbedoTables::of(appearance);
  if (AlbedoTables::has_reflection(appearance)) expect_same(a.reflection, b.reflection);
  if (AlbedoTables::has_glass(appearance)) {
    expect_same(a.glass_outside, b.glass_outside);
    expect_same(a.glass_inside, b.glass_inside);
  }
  ASSERT_EQ(a.top != nullptr, b.top != nullptr);
  if (!a.top) return;
  EXPECT_EQ(a.top->mean_passed(), b.top->mean_passed());
  for (const float mu : {0.1f, 0.5f, 1.0f}) {
    EXPECT_EQ(a.top->passed(mu), b.top->passed(mu));
    EXPECT_EQ(a.top->tint(mu), b.top->tint(mu));
    EXPECT_EQ(a.top->sheen_share(mu), b.top->sheen_share(mu));
    EXPECT_EQ(a.top->coat_share(mu), b.top->coat_share(mu));
  }
}

TEST(AlbedoCache, MakesTablesOfOneMaterialOnceWhateverItsColour) {
  AlbedoCache cache;
  Appearance appearance = layered(0.3f);
  const AlbedoTables* const first = &cache.of(appearance);
  for (int k = 0; k < 300; ++k) {
    appearance.base_color = appearance.emission = Vec3f::Constant(static_cast<float>(k) / 300);
    EXPECT_EQ(&cache.of(appearance), first);
  }
  EXPECT_EQ(cache.size(), 1u);
}

TEST(AlbedoCache, MakesLayersOnceForAllRoughnessesBelowThem) {
  AlbedoCache cache;
  const AlbedoTables smooth = cache.of(layered(0.1f)), rough = cache.of(layered(0.9f));
  EXPECT_EQ(smooth.top, rough.top);
  EXPECT_NE(smooth.reflection.mean(), rough.reflection.mean());
}

TEST(AlbedoCache, GivesEveryAppearanceItsOwnTables) {
  AlbedoCache cache;
  const std::vector<std::function<void(Appearance&)>> changes{
      [](Appearance&) {},
      [](Appearance& a) { a.roughness = 0.8f; },
      [](Appearance& a) { a.ior = 1.3f; },
      [](Appearance& a) { a.metallic = 1; },
      [](Appearance& a) { a.transmission = 0; },
      [](Appearance& a) { a.coat = 0; },
      [](Appearance& a) { a.coat = 0.2f; },
      [](Appearance& a) { a.coat_roughness = 0.5f; },
      [](Appearance& a) { a.coat_ior = 1.8f; },
      [](Appearance& a) { a.coat_color.z() = 0.5f; },
      [](Appearance& a) { a.sheen = 0; },
      [](Appearance& a) { a.sheen_roughness = 0.9f; },
      [](Appearance& a) { a.sheen_color.y() = 0.5f; },
      [](Appearance& a) { a.coat = a.sheen = 0; },
      [](Appearance& a) { a.coat = a.sheen = a.transmission = 0; },
      [](Appearance& a) { a.coat = a.sheen = a.transmission = a.specular = 0; },
      [](Appearance& a) { a.coat = a.sheen = a.transmission = a.specular = 0, a.subsurface = 1; },
  };
  for (const auto& change : changes) {
    Appearance appearance = layered(0.3f);
    change(appearance);
    expect_tables_of(appearance, cache.of(appearance));
  }
}

TEST(AlbedoCache, DropsWhatOneFrameDidNotUse) {
  AlbedoCache cache;
  cache.of(layered(0.1f));
  cache.of(layered(0.2f));
  cache.drop_unused();
  EXPECT_EQ(cache.size(), 2u);
  cache.of(layered(0.2f));
  cache.drop_unused();
  EXPECT_EQ(cache.size(), 1u);
  expect_tables_of(layered(0.1f), cache.of(layered(0.1f)));
}

TEST(AlbedoCache, FramesHaveTheBitsOfFramesAlone) {
  const auto scene_of = [](float roughness) {
    Scene scene = scene_in_sky(0.7f);
    for (const float x : {-1.0f, 0.0f, 1.0f})
      scene.meshes.push_back(sphere(Vec3f(x, 0, 0), 0.4f, layered(roughness + 0.1f * x), 12));
    scene.camera = camera_above(5, 3);
    return scene;
  };
  const Threads threads(2);
  StageTimes times;
  PathTracer tracer(threads, times);
  for (const float roughness : {0.3f, 0.4f, 0.3f}) {
    const Image in_sequence = tracer.render(scene_of(roughness), small_params(16, 2));
    const Image alone = rendered(scene_of(roughness), small_params(16, 2));
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(in_sequence.channels[c].pixels, alone.channels[c].pixels);
  }
}

}  // namespace
}  // namespace softreel
