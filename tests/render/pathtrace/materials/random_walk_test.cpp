// Scattering inside bodies: colours as asked for, no energy made, none of white lost.
#include "render/pathtrace/materials/random_walk.h"

#include <gtest/gtest.h>

#include "render/pathtrace/rays/sampling.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// The space below y = 0, down to a depth.
class Slab : public RayScene {
 public:
  explicit Slab(float depth) : depth_(depth) {}
  void build(const std::vector<const MotionMesh*>& /*meshes*/, double /*paths*/) override {}
  bool intersect(const Ray& /*ray*/, RayHit& /*hit*/) const override { return false; }
  bool occluded(const Ray& /*ray*/) const override { return false; }
  bool intersect_body(Index mesh, const Ray& ray, RayHit& hit, bool& front) const override {
    const float wall = ray.direction.y() > 0 ? 0 : -depth_;
    const float distance = (wall - ray.origin.y()) / ray.direction.y();
    if (!(distance <= ray.max_distance) || std::isinf(distance)) return false;
    hit.distance = std::max(0.0f, distance);
    hit.mesh = mesh;
    front = false;
    return true;
  }

 private:
  float depth_;
};

/// Means over walks that enter a slab from above, evenly over the projected hemisphere.
struct SlabLight {
  Eigen::Vector3d reflected = Eigen::Vector3d::Zero(), transmitted = Eigen::Vector3d::Zero();
  Eigen::Vector3d spread = Eigen::Vector3d::Zero();  ///< mean distance of reflected light from where it entered
  Eigen::Vector3d error = Eigen::Vector3d::Zero();   ///< standard error of `reflected`
};

SlabLight light_of(const Slab& slab, const ScatteringMedium& medium, int walks) {
  SlabLight light;
  RandomStream numbers(2008);
  for (int k = 0; k < walks; ++k) {
    const float a = numbers.next(), b = numbers.next();
    const Vec3f down = -cosine_hemisphere(Vec2f(a, b));
    WalkStart start;
    start.ray.origin = Vec3f(0, -1e-6f, 0);
    start.ray.direction = Vec3f(down.x(), down.z(), down.y());
    start.choice = numbers.next();
    start.first = numbers.next();
    WalkExit exit;
    if (!random_walk(slab, 0, medium, start, numbers, exit)) continue;
    const Eigen::Vector3d weight = exit.weight.cast<double>() / walks;
    if (exit.ray.direction.y() < 0) {
      light.transmitted += weight;
      continue;
    }
    const Vec3f out = exit.ray.origin + exit.hit.distance * exit.ray.direction;
    light.reflected += weight;
    light.error += weight.cwiseAbs2();
    light.spread += weight * std::hypot(static_cast<double>(out.x()), static_cast<double>(out.z()));
  }
  light.spread = light.spread.cwiseQuotient(light.reflected);
  light.error = (light.error - light.reflected.cwiseAbs2() / walks).cwiseSqrt();
  return light;
}

Subsurface inside(const Vec3f& color, const Vec3f& radius, float anisotropy) {
  Subsurface subsurface;
  subsurface.color = color;
  subsurface.radius = radius;
  subsurface.anisotropy = anisotropy;
  return subsurface;
}

constexpr float kDeep = 1e9f;

TEST(RandomWalk, HalfSpaceReturnsTheColourAskedFor) {
  for (const float anisotropy : {-0.4f, 0.0f, 0.5f, 0.8f})
    for (const Vec3f& color : {Vec3f(0.9f, 0.5f, 0.2f), Vec3f(0.7f, 0.35f, 0.1f), Vec3f(0.97f, 0.8f, 0.05f)}) {
      const ScatteringMedium medium = medium_of(inside(color, Vec3f(0.03f, 0.01f, 0.004f), anisotropy));
      const SlabLight light = light_of(Slab(kDeep), medium, 50000);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(light.reflected[c], color[c], 0.01 + 3 * light.error[c]) << "g " << anisotropy << ", channel " << c;
        EXPECT_LT(light.error[c], 0.008) << "the variance of one walk's weight is above 3";
      }
    }
}

TEST(RandomWalk, EachChannelGoesItsOwnWay) {
  // Weighing by all channels: each must get what it gets alone, though the others set its lengths.
  const Vec3f colors(0.8f, 0.6f, 0.4f), radii(0.05f, 0.01f, 0.003f);
  const SlabLight together = light_of(Slab(0.02f), medium_of(inside(colors, radii, 0.3f)), 60000);
  for (int c = 0; c < 3; ++c) {
    const Subsurface alone = inside(Vec3f::Constant(colors[c]), Vec3f::Constant(radii[c]), 0.3f);
    const SlabLight light = light_of(Slab(0.02f), medium_of(alone), 60000);
    EXPECT_NEAR(together.reflected[c], light.reflected[c], 0.012) << c;
    EXPECT_NEAR(together.transmitted[c], light.transmitted[c], 0.012) << c;
    EXPECT_NEAR(together.spread[c], light.spread[c], 0.08 * light.spread[c]) << c;
  }
}

TEST(RandomWalk, WhiteLosesNothing) {
  const ScatteringMedium white = medium_of(inside(Vec3f::Ones(), Vec3f::Constant(0.01f), 0));
  EXPECT_NEAR(white.albedo.minCoeff(), 1, 1e-6);
  const SlabLight thin = light_of(Slab(0.02f), white, 5000);
  EXPECT_NEAR(thin.reflected.x() + thin.transmitted.x(), 1, 1e-5);
  EXPECT_GT(thin.transmitted.x(), 0.1);
  const SlabLight thick = light_of(Slab(1), white, 5000);
  EXPECT_NEAR(thick.reflected.x() + thick.transmitted.x(), 1, 1e-5) << "the rest leaves after the last step";
}

TEST(RandomWalk, BlackReturnsNothing) {
  const SlabLight light = light_of(Slab(kDeep), medium_of(inside(Vec3f::Zero(), Vec3f::Ones(), 0)), 100);
  EXPECT_EQ(light.reflected.sum(), 0);
}

TEST(RandomWalk, SpreadGoesWithTheRadius) {
  const auto spread = [](float radius, float anisotropy) {
    const Subsurface subsurface = inside(Vec3f::Constant(0.7f), Vec3f::Constant(radius), anisotropy);
    return light_of(Slab(kDeep), medium_of(subsurface), 40000).spread.x();
  };
  const double one = spread(0.01f, 0);
  EXPECT_NEAR(spread(0.03f, 0), 3 * one, 0.1 * one) << "everything inside is similar";
  // The profile that the radius d is defined by, (exp(-r/d) + exp(-r/3d)) / (8 pi d r) of Christensen and Burley 2015,
  // has the mean distance 2.5 d.
  EXPECT_NEAR(one, 0.025, 0.0025);
  EXPECT_NEAR(spread(0.01f, 0.7f), one, 0.35 * one) << "anisotropy keeps the transport length";
}

Appearance waxy(const Vec3f& color, float radius) {
  Appearance appearance;
  appearance.base_color = color;
  appearance.subsurface = 1;
  appearance.subsurface_radius = Vec3f::Constant(radius);
  return appearance;
}

RenderParams deep_params(int size, int samples) {
  RenderParams params = small_params(size, samples);
  params.max_bounces = 32;
  return params;
}

TEST(SubsurfacePicture, WhiteFurnaceIsUniform) {
  for (const float coat : {0.0f, 1.0f})
    for (const float radius : {0.3f, 0.03f}) {
      Scene scene = scene_in_sky(0.5f);
      Appearance white = waxy(Vec3f::Ones(), radius);
      white.coat = coat;
      scene.meshes = {sphere(Vec3f(0, 0, 0), 1, white)};
      scene.camera = camera_above(5, 2.5f);
      EXPECT_NEAR(mean_of(rendered(scene, deep_params(16, 32)).channels[0]), 0.5, 0.006) << coat << ' ' << radius;
    }
}

TEST(SubsurfacePicture, LargeBodyShowsItsColour) {
  // A ball much larger than its radius of scattering is a half-space everywhere.
  Scene scene = scene_in_sky(1);
  Appearance wax = waxy(Vec3f(0.8f, 0.5f, 0.2f), 0.005f);
  wax.specular = 0;
  scene.meshes = {sphere(Vec3f(0, 0, 0), 1, wax, 48)};
  scene.camera = camera_above(5, 0.5f);
  const Image image = rendered(scene, deep_params(16, 64));
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(mean_of(image.channels[c]), wax.base_color[static_cast<Index>(c)], 0.02) << c;
}

TEST(SubsurfacePicture, LampsAndSkyAgreeWithTheDiffuseLobe) {
  // Light sampled where it leaves: a lamp over a large body gives what it gives to a diffuse one of that colour.
  Scene scene = scene_in_sky(0);
  Appearance wax = waxy(Vec3f::Constant(0.6f), 0.002f);
  wax.specular = 0;
  AreaLight lamp;
  lamp.center = Vec3f(0, 4, 0);
  lamp.u = Vec3f(0, 0, 1);
  lamp.v = Vec3f(-1, 0, 0);
  lamp.radiance = Vec3f::Constant(10);
  scene.area_lights = {lamp};
  scene.camera.position = Vec3f(3, 3, 3);
  scene.meshes = {sphere(Vec3f(0, 0, 0), 1, wax, 32)};
  const double scattered = mean_of(rendered(scene, deep_params(16, 64)).channels[0]);
  scene.meshes = {sphere(Vec3f(0, 0, 0), 1, matte(0.6f), 32)};
  const double diffuse = mean_of(rendered(scene, deep_params(16, 64)).channels[0]);
  EXPECT_NEAR(scattered, diffuse, 0.03 * diffuse);
}

TEST(SubsurfacePicture, LightEntersEvenlyToAllSides) {
  // At the edge of the light of a lamp that lies on the body it is as bright from whichever side that comes, also where
  // the walk shares its numbers with another lobe.
  Scene scene = scene_in_sky(0);
  Appearance skin = waxy(Vec3f::Constant(0.8f), 0.05f);
  skin.specular = 0;
  skin.subsurface = 0.3f;
  skin.subsurface_anisotropy = 0.9f;
  MotionMesh top = square(5, 0, skin);
  const MotionMesh bottom = square(5, -2, skin);
  for (const Triangle& t : bottom.triangles) top.triangles.push_back({t[0] + 4, t[2] + 4, t[1] + 4});
  for (const Vec3f& p : bottom.times[0].positions) top.times[0].positions.push_back(p);
  top.times[0].normals.insert(top.times[0].normals.end(), 4, Vec3f(0, -1, 0));
  scene.meshes = {top};
  scene.camera = camera_above(10, 0.002f);
  const auto brightness = [&](const Vec3f& side) {
    AreaLight lamp;
    lamp.center = side + Vec3f(0, 1e-3f, 0);
    lamp.u = side;
    lamp.v = Vec3f(0, 1, 0).cross(side);
    if (lamp.u.cross(lamp.v).y() > 0) lamp.v = -lamp.v;
    lamp.radiance = Vec3f::Ones();
    lamp.visible = false;
    scene.area_lights = {lamp};
    return mean_of(rendered(scene, deep_params(8, 1024)).channels[0]);
  };
  for (const Vec3f& side : {Vec3f(1, 0, 0), Vec3f(0, 0, 1)}) {
    const double here = brightness(side), there = brightness(-side);
    EXPECT_NEAR(here, there, 0.01 * there) << side.transpose();
  }
}

TEST(SubsurfacePicture, BodyThatOverlapsItselfIsOneBody) {
  Scene scene = scene_in_sky(0.5f);
  MotionMesh two = sphere(Vec3f(-0.3f, 0, 0), 0.7f, waxy(Vec3f::Ones(), 0.1f));
  const MotionMesh second = sphere(Vec3f(0.3f, 0, 0), 0.7f, two.appearance);
  const Index shift = static_cast<Index>(two.times[0].positions.size());
  for (const Triangle& t : second.triangles) two.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  for (const Vec3f& p : second.times[0].positions) two.times[0].positions.push_back(p);
  for (const Vec3f& n : second.times[0].normals) two.times[0].normals.push_back(n);
  scene.meshes = {two};
  scene.camera = camera_above(5, 2.2f);
  EXPECT_NEAR(mean_of(rendered(scene, deep_params(16, 32)).channels[0]), 0.5, 0.006);
}

TEST(SubsurfacePicture, OpenMeshIsDarkerNeverBrighter) {
  Scene scene = scene_in_sky(0.5f);
  MotionMesh open = sphere(Vec3f(0, 0, 0), 1, waxy(Vec3f::Ones(), 0.1f));
  std::erase_if(open.triangles,
                [&](const Triangle& t) { return open.times[0].positions[static_cast<std::size_t>(t[0])].y() < 0; });
  scene.meshes = {open};
  scene.camera = camera_above(5, 2.5f);
  const Image image = rendered(scene, deep_params(16, 32));
  const double mean = mean_of(image.channels[0]);
  EXPECT_LT(mean, 0.5);
  EXPECT_GT(mean, 0.25);
  for (const float value : image.channels[0].pixels) EXPECT_TRUE(std::isfinite(value));
}

}  // namespace
}  // namespace softreel
