// Bodies that shine light others as their geometry says, found by sampling their triangles.
#include "render/pathtrace/lights/emitting_meshes.h"

#include <gtest/gtest.h>

#include "render/pathtrace/rays/sampler.h"
#include "render/pathtrace/rays/sampling.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

Appearance glowing(float radiance) {
  Appearance appearance = matte(0);
  appearance.emission = Vec3f::Constant(radiance);
  return appearance;
}

/// A black floor patch under the middle of the picture, lit by `lamp`.
Scene over_a_floor(const MotionMesh& lamp, float albedo) {
  Scene scene = scene_in_sky(0);
  scene.meshes = {square(0.5f, 0, matte(albedo)), lamp};
  // From the side, so that the lamp is not in the way; the picture covers 2 cm.
  scene.camera.position = Vec3f(4, 4, 0);
  scene.camera.target = Vec3f::Zero();
  scene.camera.focal_length_mm = 36 * 5.657f / 0.02f;
  return scene;
}

double floor_radiance(const Scene& scene, int samples) {
  return mean_of(rendered(scene, small_params(8, samples)).channels[0]);
}

TEST(EmittingMeshes, AGlowingSphereLightsAFloorByItsSolidAngle) {
  const double expected = 0.8 / M_PI * M_PI * 3 * 0.25 * 0.25;
  const Scene scene = over_a_floor(sphere(Vec3f(0, 1, 0), 0.25f, glowing(3), 32), 0.8f);
  EXPECT_NEAR(floor_radiance(scene, 256), expected, 0.01 * expected) << "the mesh is a little smaller than the sphere";
}

TEST(EmittingMeshes, LittleNoiseWithASmallLamp) {
  // Solid angle 2e-4 of the hemisphere: by chance 1 ray in 2500 finds it, and pixels of 4 samples would be black.
  const Scene scene = over_a_floor(sphere(Vec3f(0, 2, 0), 0.04f, glowing(100), 12), 0.8f);
  const Image image = rendered(scene, small_params(16, 4));
  const double mean = mean_of(image.channels[0]);
  Channel flat = image.channels[0];
  for (float& value : flat.pixels) value = static_cast<float>(mean);
  EXPECT_NEAR(mean, 0.8 * 100 * 0.0004, 0.03 * 0.032);
  EXPECT_LT(rms_difference(image.channels[0], flat), 0.5 * mean);
}

TEST(EmittingMeshes, AMovingLampGivesTheMeanOverTheShutter) {
  // Up from 1 to 2 m: the mean of 1 / h^2 over it is 1/2.
  MotionMesh lamp = sphere(Vec3f(0, 1, 0), 0.1f, glowing(3), 32);
  lamp.times.push_back(lamp.times[0]);
  for (Vec3f& p : lamp.times[1].positions) p.y() += 1;
  const double expected = 0.8 * 3 * 0.01 * 0.5;
  EXPECT_NEAR(floor_radiance(over_a_floor(lamp, 0.8f), 64), expected, 0.015 * expected);
}

TEST(EmittingMeshes, LightComesFromTheFrontOnly) {
  MotionMesh down = square(0.5f, 1, glowing(2));
  for (Triangle& t : down.triangles) std::swap(t[0], t[1]);
  for (Vec3f& n : down.times[0].normals) n = -n;
  EXPECT_GT(floor_radiance(over_a_floor(down, 0.8f), 8), 0.1);
  EXPECT_EQ(floor_radiance(over_a_floor(square(0.5f, 1, glowing(2)), 0.8f), 8), 0);
}

TEST(EmittingMeshes, DensitiesAreThoseOfTheSamples) {
  const std::vector<MotionMesh> meshes{square(1, 0, matte(1)), sphere(Vec3f(0.3f, 1, 0), 0.5f, glowing(1), 8)};
  const EmittingMeshes lights(meshes);
  const TreeReceiver receiver{Vec3f::Zero(), Vec3f(0, 1, 0), false};
  // The mean of 1 / pdf over the samples is the solid angle: of the sphere, 2 pi (1 - cos), a little less for its mesh.
  const Sampler sampler(1, 1, 1);
  double sum = 0;
  const int samples = 1 << 14;
  for (int s = 0; s < samples; ++s) {
    const SampleBlock u = sampler.numbers(static_cast<std::uint32_t>(s), 0);
    LightSample sample;
    if (lights.sample(receiver, 0, u[4], Vec2f(u[0], u[1]), sample)) sum += 1 / static_cast<double>(sample.pdf);
  }
  const double cosine = std::sqrt(1 - 0.25 / 1.09);
  EXPECT_NEAR(sum / samples, 2 * M_PI * (1 - cosine), 0.05 * 2 * M_PI * (1 - cosine));
  RayHit floor_hit;
  floor_hit.mesh = 0;
  floor_hit.triangle = 0;
  Ray ray;
  ray.direction = Vec3f(0, -1, 0);
  EXPECT_EQ(lights.pdf(receiver, ray, floor_hit), 0) << "the floor does not emit";
}

}  // namespace
}  // namespace softreel
