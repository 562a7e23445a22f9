// Trees that are fitted from the shape at rest find what trees of the frame alone find, and remember no other frame.
#include <cmath>

#include <gtest/gtest.h>

#include "render/pathtrace/rays/ray_scene.h"
#include "render/pathtrace/rays/tree_fit.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

constexpr double kFew = 10;  ///< paths, for which building anew never pays

std::shared_ptr<const std::vector<Vec3f>> shared_rest(const MotionMesh& mesh) {
  return std::make_shared<const std::vector<Vec3f>>(mesh.times[0].positions);
}

/// Two balls that are sheared by `lean`, and a square that stands still and has no shape at rest.
struct Balls {
  explicit Balls(float lean, float subsurface = 0) {
    Appearance look = matte(0.5f);
    look.subsurface = subsurface;
    meshes = {sphere(Vec3f(-1, 0, 0), 0.75f, look, 32), square(4, -1, matte(0.5f)),
              sphere(Vec3f(1, 0, 0), 0.75f, look, 16)};
    static const auto left = shared_rest(meshes[0]), right = shared_rest(meshes[2]);
    meshes[0].rest_positions = left;
    meshes[2].rest_positions = right;
    for (MotionMesh* ball : {&meshes[0], &meshes[2]})
      for (Vec3f& p : ball->times[0].positions) p.x() += lean * p.y();
  }

  std::vector<const MotionMesh*> all() const { return {&meshes[0], &meshes[1], &meshes[2]}; }
  std::vector<MotionMesh> meshes;
};

/// At the middles of faces, the middles of edges and the corners of all triangles, from one point: the last two meet
/// two triangles and more at equal distances.
std::vector<Ray> rays_at(const std::vector<MotionMesh>& meshes) {
  std::vector<Ray> rays;
  const Vec3f origin(0.25f, 3, 5);
  for (const MotionMesh& mesh : meshes)
    for (const Triangle& t : mesh.triangles) {
      const auto corner = [&](std::size_t k) { return mesh.times[0].positions[static_cast<std::size_t>(t[k])]; };
      for (const Vec3f& aim :
           {Vec3f((corner(0) + corner(1) + corner(2)) / 3), Vec3f((corner(0) + corner(1)) / 2), corner(2)})
        rays.push_back({origin, (aim - origin).normalized()});
    }
  return rays;
}

std::vector<RayHit> hits(const RayScene& scene, const std::vector<Ray>& rays) {
  std::vector<RayHit> found(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) scene.intersect(rays[k], found[k]);
  return found;
}

bool are_equal(const RayHit& a, const RayHit& b) {
  return a.distance == b.distance && a.u == b.u && a.v == b.v && a.mesh == b.mesh && a.triangle == b.triangle;
}

int differences(const std::vector<RayHit>& a, const std::vector<RayHit>& b) {
  EXPECT_EQ(a.size(), b.size());
  int count = 0;
  for (std::size_t k = 0; k < a.size(); ++k) count += are_equal(a[k], b[k]) ? 0 : 1;
  return count;
}

std::vector<RayHit> hits_alone(const Balls& balls, const std::vector<Ray>& rays, int threads = 2) {
  const auto scene = make_ray_scene(threads);
  const Threads run_on(threads);
  run_on.run([&] { scene->build(balls.all(), kFew); });
  return hits(*scene, rays);
}

TEST(FittedTrees, FindWhatTreesOfTheFrameAloneFind) {
  const Balls balls(0.4f);
  std::vector<MotionMesh> without_rest = balls.meshes;
  for (MotionMesh& mesh : without_rest) mesh.rest_positions = nullptr;
  const auto anew = make_ray_scene(2);
  anew->build({&without_rest[0], &without_rest[1], &without_rest[2]}, kFew);
  const std::vector<Ray> rays = rays_at(balls.meshes);
  const std::vector<RayHit> fitted = hits_alone(balls, rays), expected = hits(*anew, rays);
  int ties_told_apart = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (are_equal(fitted[k], expected[k])) continue;
    ASSERT_NE(k % 3, 0U) << "ray " << k << " meets the middle of a triangle";
    ++ties_told_apart;
  }
  EXPECT_LT(ties_told_apart, static_cast<int>(rays.size() / 100));
}

TEST(FittedTrees, FindTheSameBitsAloneAndAfterOtherFrames) {
  const Balls balls(0.4f), other(-0.9f), rest(0);
  const std::vector<Ray> rays = rays_at(balls.meshes);
  const auto scene = make_ray_scene(2);
  for (const Balls* frame : {&other, &rest, &balls}) scene->build(frame->all(), kFew);
  EXPECT_EQ(differences(hits(*scene, rays), hits_alone(balls, rays)), 0);
}

TEST(FittedTrees, FindTheSameBitsAfterFramesThatMoveOrAreFarFromRest) {
  const Balls balls(0.4f);
  Balls blurred(0.1f), torn(0);
  blurred.meshes[0].times.push_back(blurred.meshes[0].times[0]);
  for (std::size_t k = 0; k < torn.meshes[0].times[0].positions.size(); ++k)
    torn.meshes[0].times[0].positions[k].z() += k % 3 == 0 ? 2.0f : 0.0f;
  const std::vector<Ray> rays = rays_at(balls.meshes);
  const auto scene = make_ray_scene(2);
  scene->build(blurred.all(), kFew);
  scene->build(torn.all(), 1e9);
  scene->build(balls.all(), kFew);
  EXPECT_EQ(differences(hits(*scene, rays), hits_alone(balls, rays)), 0);
}

TEST(FittedTrees, AreMadeAnewWhenWhatKnowsNoRestChanges) {
  const Balls balls(0.4f);
  Balls higher(0.4f);
  for (Vec3f& p : higher.meshes[1].times[0].positions) p.y() += 0.5f;
  const std::vector<Ray> rays = rays_at(balls.meshes);
  const auto scene = make_ray_scene(2);
  scene->build(higher.all(), kFew);
  const std::vector<RayHit> of_higher = hits(*scene, rays);
  scene->build(balls.all(), kFew);
  EXPECT_EQ(differences(hits(*scene, rays), hits_alone(balls, rays)), 0);
  EXPECT_GT(differences(of_higher, hits_alone(balls, rays)), 0);
}

TEST(FittedTrees, DoNotDependOnTheNumberOfThreads) {
  const Balls balls(0.4f);
  const std::vector<Ray> rays = rays_at(balls.meshes);
  EXPECT_EQ(differences(hits_alone(balls, rays, 1), hits_alone(balls, rays, 4)), 0);
}

TEST(FittedTrees, KnowEachScatteringBodyByItself) {
  const Balls balls(0.4f, 0.5f);
  const auto scene = make_ray_scene(2);
  scene->build(Balls(0, 0.5f).all(), kFew);
  scene->build(balls.all(), kFew);
  // Through both balls along x: each finds itself only, from inside its back.
  for (const Index mesh : {0, 2}) {
    const float middle = mesh == 0 ? -1.0f : 1.0f;
    RayHit hit;
    bool front = false;
    ASSERT_TRUE(scene->intersect_body(mesh, {Vec3f(-4, 0.01f, 0.01f), Vec3f(1, 0, 0)}, hit, front));
    EXPECT_TRUE(front);
    EXPECT_EQ(hit.mesh, mesh);
    EXPECT_NEAR(hit.distance, 4 + middle - 0.75f, 0.02f);
    ASSERT_TRUE(scene->intersect_body(mesh, {Vec3f(middle, 0.01f, 0.01f), Vec3f(1, 0, 0)}, hit, front));
    EXPECT_FALSE(front);
    EXPECT_NEAR(hit.distance, 0.75f, 0.02f);
  }
}

TEST(FittedTrees, TellMeshesApartThatStandAmongEmptyOnes) {
  const Balls balls(0.4f);
  MotionMesh empty;
  empty.times.resize(1);
  const auto among = make_ray_scene(2), alone = make_ray_scene(2);
  among->build({&empty, &balls.meshes[0], &empty, &empty, &balls.meshes[1], &balls.meshes[2], &empty}, kFew);
  alone->build(balls.all(), kFew);
  const std::vector<Ray> rays = rays_at(balls.meshes);
  std::vector<RayHit> found = hits(*among, rays);
  for (RayHit& hit : found) {
    if (hit.mesh < 0) continue;
    ASSERT_TRUE(hit.mesh == 1 || hit.mesh == 4 || hit.mesh == 5) << hit.mesh;
    hit.mesh = hit.mesh == 1 ? 0 : hit.mesh - 3;
  }
  EXPECT_EQ(differences(found, hits(*alone, rays)), 0);
}

TEST(FittedTrees, GiveTheSamePictureAloneAndInASequence) {
  const auto scene_of = [](float lean) {
    Scene scene = scene_in_sky(1);
    scene.meshes = Balls(lean).meshes;
    scene.ground.emplace();
    scene.camera.position = Vec3f(0.3f, 1.5f, 6);
    scene.camera.target = Vec3f(0, 0, 0);
    return scene;
  };
  const RenderParams params = small_params(48, 2);
  const Threads threads(2);
  StageTimes times;
  PathTracer tracer(threads, times);
  tracer.render(scene_of(-0.8f), params);
  tracer.render(scene_of(0.1f), params);
  const Image in_sequence = tracer.render(scene_of(0.4f), params), alone = rendered(scene_of(0.4f), params);
  for (std::size_t c = 0; c < alone.channels.size(); ++c)
    EXPECT_EQ(in_sequence.channels[c].pixels, alone.channels[c].pixels);
}

}  // namespace
}  // namespace softreel
