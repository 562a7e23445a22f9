// Equal scenes give equal bits, whatever the threads and whatever was rendered before.
#include <atomic>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "render/pathtrace/path_tracer.h"
#include "render/pathtrace/picture_hash.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

Scene some_scene(float lean) {
  Scene scene;
  Appearance glossy;
  glossy.roughness = 0.3f;
  MotionMesh ball = sphere(Vec3f(0, 0.6f, 0), 0.5f, glossy, 48);
  ball.times.push_back(ball.times[0]);
  for (Vec3f& p : ball.times[1].positions) p.x() += lean * p.y();
  scene.meshes = {ball};
  scene.ground.emplace();
  scene.ground->checker = 0.25f;
  AreaLight lamp;
  lamp.radiance = Vec3f::Constant(20);
  scene.area_lights = {lamp};
  scene.suns.resize(1);
  scene.camera.f_number = 2;
  return scene;
}

void expect_equal_bits(const Image& a, const Image& b) {
  ASSERT_EQ(a.channels.size(), b.channels.size());
  for (std::size_t c = 0; c < a.channels.size(); ++c) EXPECT_EQ(a.channels[c].pixels, b.channels[c].pixels);
}

TEST(PathTracer, GivesTheSameBitsWithOneAndFourThreads) {
  RenderParams params = small_params(48, 4);
  params.auxiliary = true;
  expect_equal_bits(rendered(some_scene(0.2f), params, 1), rendered(some_scene(0.2f), params, 4));
}

TEST(PathTracer, HasNoMemoryOfEarlierFrames) {
  const RenderParams params = small_params(32, 4);
  const Threads threads(2);
  StageTimes times;
  PathTracer tracer(threads, times);
  const Image first = tracer.render(some_scene(0.2f), params);
  tracer.render(some_scene(0.7f), params);
  Scene other = some_scene(0);
  other.meshes.clear();
  tracer.render(other, params);
  expect_equal_bits(first, tracer.render(some_scene(0.2f), params));
  expect_equal_bits(first, rendered(some_scene(0.2f), params));
  EXPECT_EQ(times.entries()["render/trace"].calls, 4);
}

TEST(PathTracer, StopsWhenCancelled) {
  std::atomic<int> asked = 0;
  const Threads threads(2);
  StageTimes times;
  PathTracer tracer(threads, times);
  try {
    tracer.render(some_scene(0), small_params(64, 1), [&] { return ++asked > 2; });
    FAIL() << "not interrupted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Interrupt);
  }
}

TEST(PathTracer, AcceptsAnEmptyScene) {
  Scene scene;
  EXPECT_NEAR(mean_of(rendered(scene, small_params(4, 1)).channels[0]), 0.45, 0.1);
}

TEST(PictureHash, SeesGeometryAndCameraButNotLightsOrMaterials) {
  const Scene scene = some_scene(0.2f);
  const std::uint64_t hash = picture_hash(scene);
  EXPECT_EQ(hash, picture_hash(some_scene(0.2f)));
  EXPECT_NE(hash, picture_hash(some_scene(0.2001f)));
  Scene moved = scene;
  moved.camera.focal_length_mm += 1e-3f;
  EXPECT_NE(hash, picture_hash(moved));
  for (const float f_number : {0.0f, 2.0f}) {  // without a lens there is no focus
    Scene near = scene;
    near.camera.f_number = f_number;
    Scene far = near;
    far.camera.focus_distance = 5;
    EXPECT_EQ(picture_hash(near) == picture_hash(far), f_number == 0);
  }
  Scene relit = scene;
  relit.suns.clear();
  relit.meshes[0].appearance.roughness = 1;
  EXPECT_EQ(hash, picture_hash(relit));
}

}  // namespace
}  // namespace softreel
