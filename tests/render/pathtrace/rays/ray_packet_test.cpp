// Rays that are shot together find what each finds alone, whatever company it is in, but for triangles at equal
// distances.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "render/pathtrace/rays/scene_rays.h"
#include "render/pathtrace/rays/tree_fit.h"
#include "render/scene/ground_mesh.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

constexpr double kOnePath = 1;  ///< for which building anew never pays

/// A ball and a square; moving: the ball leans while the shutter is open.
std::vector<MotionMesh> ball_and_square(bool moving) {
  std::vector<MotionMesh> meshes{sphere(Vec3f(0, 0.5f, 0), 0.75f, matte(0.5f), 24), square(2, -1, matte(0.5f))};
  if (!moving) return meshes;
  meshes[0].times.push_back(meshes[0].times[0]);
  for (Vec3f& p : meshes[0].times[1].positions) p.x() += 0.5f * p.y();
  return meshes;
}

std::vector<const MotionMesh*> addresses(const std::vector<MotionMesh>& meshes) {
  std::vector<const MotionMesh*> all;
  for (const MotionMesh& mesh : meshes) all.push_back(&mesh);
  return all;
}

/// Groups of similar rays, as of pixels, and every fourth one any ray of the neighbourhood; of all lengths.
std::vector<Ray> some_rays(std::size_t count) {
  std::mt19937 random(2008);
  const auto number = [&](float least, float most) { return std::uniform_real_distribution(least, most)(random); };
  std::vector<Ray> rays;
  Vec3f aim = Vec3f::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    if (k % kRayPacket == 0) aim = Vec3f(number(-1, 1), number(-1, 1), number(-1, 1));
    Ray ray;
    ray.origin = k % 4 == 3 ? Vec3f(number(-3, 3), number(-3, 3), number(-3, 3)) : Vec3f(0.25f, 3, 5);
    const Vec3f spread(number(-1, 1), number(-1, 1), number(-1, 1));
    ray.direction = (aim + 0.02f * spread - ray.origin).normalized();
    if (k % 3 == 0) ray.max_distance = number(0, 8);
    ray.time = number(0, 1);
    rays.push_back(ray);
  }
  return rays;
}

/// What rays find in packets of `size`.
template <typename Rays>
std::vector<RayHit> in_packets(const Rays& scene, const std::vector<Ray>& rays, std::size_t size) {
  std::vector<RayHit> found;
  for (std::size_t first = 0; first < rays.size(); first += size) {
    const std::span<const Ray> packet = std::span(rays).subspan(first, std::min(size, rays.size() - first));
    std::vector<RayHit> hits(packet.size());
    scene.intersect_packet(packet, hits);
    found.insert(found.end(), hits.begin(), hits.end());
  }
  return found;
}

bool is_same_hit(const RayHit& a, const RayHit& b) {
  if (a.mesh < 0 || b.mesh < 0) return a.mesh == b.mesh;
  return a.distance == b.distance && a.u == b.u && a.v == b.v && a.mesh == b.mesh && a.triangle == b.triangle;
}

template <typename Rays>
void expect_company_changes_nothing(const Rays& scene) {
  const std::vector<Ray> rays = some_rays(5003);
  const std::vector<RayHit> alone = in_packets(scene, rays, 1);
  for (const std::size_t size : {std::size_t{3}, kRayPacket}) {
    const std::vector<RayHit> together = in_packets(scene, rays, size);
    for (std::size_t k = 0; k < rays.size(); ++k)
      ASSERT_TRUE(is_same_hit(alone[k], together[k])) << "ray " << k << " in packets of " << size;
  }
  int hits = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    RayHit single;
    ASSERT_EQ(scene.intersect(rays[k], single), alone[k].mesh >= 0) << "ray " << k;
    if (alone[k].mesh < 0) continue;
    ++hits;
    ASSERT_EQ(alone[k].mesh, single.mesh) << "ray " << k;
    ASSERT_NEAR(alone[k].distance, single.distance, 1e-5f) << "ray " << k;
  }
  EXPECT_GT(hits, 2000);
  EXPECT_LT(hits, 4900);
}

void expect_company_changes_nothing_among(const std::vector<MotionMesh>& meshes) {
  const auto scene = make_ray_scene(1);
  scene->build(addresses(meshes), kOnePath);
  expect_company_changes_nothing(*scene);
}

TEST(RayPacket, ChangesNothingInTreesOfAFrame) {
  expect_company_changes_nothing_among(ball_and_square(false));
}

TEST(RayPacket, ChangesNothingInFittedTrees) {
  std::vector<MotionMesh> meshes = ball_and_square(false);
  meshes[0].rest_positions = std::make_shared<const std::vector<Vec3f>>(meshes[0].times[0].positions);
  for (Vec3f& p : meshes[0].times[0].positions) p.x() += 0.2f * p.y();
  const TreeFit fit(*meshes[0].rest_positions, meshes[0].triangles);
  ASSERT_TRUE(is_worth_fitting(fit.looseness(meshes[0].times[0].positions), meshes[0].triangles.size(), kOnePath))
      << "the trees would be of the frame";
  expect_company_changes_nothing_among(meshes);
}

TEST(RayPacket, ChangesNothingWhileBodiesMove) {
  expect_company_changes_nothing_among(ball_and_square(true));
}

TEST(RayPacket, ChangesNothingBesideTheSweptGround) {
  std::vector<MotionMesh> meshes = ball_and_square(false);
  meshes.pop_back();
  const auto scene = make_ray_scene(1);
  scene->build(addresses(meshes), kOnePath);
  Ground ground;
  ground.height = -1;
  ground.size = 4;
  expect_company_changes_nothing(SceneRays(*scene, addresses(meshes), ground_shape(ground, Camera{})));
}

}  // namespace
}  // namespace softreel
