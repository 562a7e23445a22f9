// The channels beside the colour, against what geometry says they are.
#include "render/pathtrace/pixel_channels.h"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "render/image/cryptomatte.h"
#include "render/pathtrace/path_tracer.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

RenderParams with(std::initializer_list<PictureChannel> channels, int size = 40, int samples = 8) {
  RenderParams params = small_params(size, samples);
  params.max_bounces = 1;
  for (const PictureChannel channel : channels) params.channels.add(channel);
  return params;
}

float value(const Image& image, const char* name, int x, int y) {
  return image.find(name)->pixels[static_cast<std::size_t>(y * image.width + x)];
}

/// A box with edges 2 * half around a center, without normals.
MotionMesh box(const Vec3f& center, float half) {
  MotionMesh mesh;
  mesh.name = "box";
  mesh.times.resize(1);
  for (int k = 0; k < 8; ++k)
    mesh.times[0].positions.push_back(center +
                                      half * Vec3f(k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

std::vector<Vec3f> moved(const std::vector<Vec3f>& positions, const Vec3f& by) {
  std::vector<Vec3f> result;
  for (const Vec3f& p : positions) result.push_back(p + by);
  return result;
}

/// 4 m above the origin; 40 pixels see 2 m of the plane y = 0, so that 1 m is 20 pixels there; z grows downwards.
Scene scene_from_above() {
  Scene scene = scene_in_sky(1);
  scene.camera = camera_above(4, 2);
  return scene;
}

TEST(MotionChannel, OfATranslatingBoxIsItsShiftInPixels) {
  Scene scene = scene_from_above();
  scene.meshes = {box(Vec3f(0, 0.2f, 0), 0.3f)};
  // The top is at 0.5 m: 3.5 m from the camera, where 1 m is 20 * 4 / 3.5 pixels.
  scene.meshes[0].next_positions = moved(scene.meshes[0].times[0].positions, Vec3f(0.1f, 0, -0.05f));
  const Image image = rendered(scene, with({PictureChannel::Motion}));
  const float pixels = 20 * 4 / 3.5f;
  for (const int at : {16, 20, 23}) {
    EXPECT_NEAR(value(image, "motion.X", at, 20), 0.1f * pixels, 1e-3);
    EXPECT_NEAR(value(image, "motion.Y", at, 20), -0.05f * pixels, 1e-3) << "away from the viewer is up";
  }
  EXPECT_EQ(value(image, "motion.X", 2, 2), 0) << "the sky stands still";
}

TEST(MotionChannel, OfAnApproachingPlaneGrowsFromTheMiddle) {
  Scene scene = scene_from_above();
  scene.meshes = {square(5, 0, matte(0.5f))};
  scene.meshes[0].next_positions = moved(scene.meshes[0].times[0].positions, Vec3f(0, 2, 0));  // half the distance
  const Image image = rendered(scene, with({PictureChannel::Motion}, 40, 64));
  for (const int x : {4, 12, 30}) {
    // A point at the pixel's middle goes to twice its distance from the picture's middle.
    EXPECT_NEAR(value(image, "motion.X", x, 8), static_cast<float>(x) + 0.5f - 20, 0.02);
    EXPECT_NEAR(value(image, "motion.Y", x, 8), 8.5f - 20, 0.02);
  }
}

TEST(MotionChannel, MotionBlurDoesNotChangeIt) {
  Scene scene = scene_from_above();
  scene.meshes = {square(5, 0, matte(0.5f))};
  MotionMesh& mesh = scene.meshes[0];
  const std::vector<Vec3f> now = mesh.times[0].positions;
  mesh.times = {{moved(now, Vec3f(-0.3f, 0, 0)), {}}, {moved(now, Vec3f(-0.1f, 0, 0)), {}}, {now, {}}};
  mesh.next_positions = moved(now, Vec3f(0.2f, 0, 0));
  const Image image = rendered(scene, with({PictureChannel::Motion}));
  for (const int x : {3, 20, 33}) EXPECT_NEAR(value(image, "motion.X", x, 11), 4, 1e-3) << "0.2 m at 20 pixels a metre";
}

TEST(MotionChannel, OfTheCameraMovesEverythingTheOtherWay) {
  Scene scene = scene_from_above();
  scene.meshes = {square(0.5f, 0, matte(0.5f))};
  scene.next_camera = scene.camera;
  scene.next_camera->position.x() += 0.1f;
  scene.next_camera->target.x() += 0.1f;
  const Image image = rendered(scene, with({PictureChannel::Motion}));
  EXPECT_NEAR(value(image, "motion.X", 20, 20), -2, 1e-3);
  EXPECT_NEAR(value(image, "motion.Y", 20, 20), 0, 1e-3);
  EXPECT_NEAR(value(image, "motion.X", 2, 2), 0, 1e-3) << "a sky is too far away to be shifted";
}

TEST(MotionChannel, OfTheSkyFollowsTheCamerasTurning) {
  Scene scene = scene_in_sky(1);
  scene.camera.position = Vec3f(0, 0, 0);
  scene.camera.target = Vec3f(0, 0, -1);
  scene.camera.sensor_width_mm = 36;
  scene.camera.focal_length_mm = 18;  // the window one metre ahead is 2 m wide
  scene.next_camera = scene.camera;
  const float angle = 0.1f;
  scene.next_camera->target = Vec3f(std::sin(angle), 0, -std::cos(angle));  // to the right
  const Image image = rendered(scene, with({PictureChannel::Motion}, 41, 64));
  EXPECT_NEAR(value(image, "motion.X", 20, 20), -20.5f * std::tan(angle), 0.02) << "the middle goes to the left";
  EXPECT_NEAR(value(image, "motion.Y", 20, 20), 0, 0.02);
}

TEST(MotionChannel, OfAShadowCatcherIsThatOfItsGround) {
  Scene scene = scene_from_above();
  scene.ground.emplace();
  scene.ground->shadow_catcher = true;
  scene.next_camera = scene.camera;
  scene.next_camera->position.x() += 0.1f;
  scene.next_camera->target.x() += 0.1f;
  const Image image = rendered(
      scene, with({PictureChannel::Motion, PictureChannel::Depth, PictureChannel::Position, PictureChannel::ObjectId}));
  EXPECT_NEAR(value(image, "motion.X", 20, 20), -2, 1e-3);
  EXPECT_NEAR(value(image, "motion.X", 4, 33), -2, 1e-3);
  EXPECT_NEAR(value(image, "motion.Y", 20, 20), 0, 1e-3);
  for (const char* name : {"A", "depth.Z", "position.Z", "CryptoObject00.G"})
    EXPECT_EQ(value(image, name, 4, 33), 0) << name << ": the rest of it is not there";
}

TEST(PositionChannel, IsWhereTheSurfaceIs) {
  Scene scene = scene_from_above();
  scene.meshes = {square(5, 0.5f, matte(0.5f))};
  const Image image = rendered(scene, with({PictureChannel::Position}, 40, 64));
  const float pixel = 2.0f / 40 * 3.5f / 4;
  EXPECT_NEAR(value(image, "position.X", 30, 12), (30.5f - 20) * pixel, 0.05f * pixel);
  EXPECT_NEAR(value(image, "position.Y", 30, 12), 0.5f, 1e-5);
  EXPECT_NEAR(value(image, "position.Z", 30, 12), (12.5f - 20) * pixel, 0.05f * pixel);
}

TEST(StrainChannel, IsTheMeshesOwnBetweenItsVertices) {
  Scene scene = scene_from_above();
  scene.meshes = {square(0.5f, 0, matte(0.5f))};
  for (const Vec3f& p : scene.meshes[0].times[0].positions) scene.meshes[0].strain.push_back(0.2f + 0.1f * p.x());
  const Image image = rendered(scene, with({PictureChannel::Strain}, 40, 64));
  EXPECT_NEAR(value(image, "strain.V", 25, 18), 0.2f + 0.1f * (25.5f - 20) / 20, 2e-4);
  EXPECT_EQ(value(image, "strain.V", 1, 1), 0);
}

/// The coverage of a name at a pixel; the sum of all where the name is empty.
float coverage(const Image& image, const std::string& layer, const std::string& name, int x, int y) {
  float sum = 0;
  for (int rank = 0; rank < kCryptomatteRanks; ++rank) {
    const std::string plane = layer + "0" + std::to_string(rank / 2);
    const float id = value(image, (plane + (rank % 2 == 0 ? ".R" : ".B")).c_str(), x, y);
    const float covered = value(image, (plane + (rank % 2 == 0 ? ".G" : ".A")).c_str(), x, y);
    if (name.empty() || std::bit_cast<std::uint32_t>(id) == cryptomatte_id(name)) sum += covered;
  }
  return sum;
}

TEST(IdChannels, CoverAsMuchAsTheObjectsDo) {
  Scene scene = scene_from_above();
  MotionMesh left = square(0.25f, 0, matte(0.5f)), right = left, other = left;
  left.times[0].positions = moved(left.times[0].positions, Vec3f(-0.2375f, 0, 0));   // ends a quarter into pixel 20
  right.times[0].positions = moved(right.times[0].positions, Vec3f(0.2875f, 0, 0));  // begins three quarters into it
  other.times[0].positions = moved(other.times[0].positions, Vec3f(0, 0, -0.7f));
  left.name = "left", right.name = "right", other.name = "left";
  left.material = right.material = "gum", other.material = "wax";
  scene.meshes = {left, right, other};
  const Image image = rendered(scene, with({PictureChannel::ObjectId, PictureChannel::MaterialId}, 40, 256));
  EXPECT_NEAR(coverage(image, "CryptoObject", "left", 20, 20), 0.25f, 0.02);
  EXPECT_NEAR(coverage(image, "CryptoObject", "right", 20, 20), 0.25f, 0.02);
  EXPECT_NEAR(coverage(image, "CryptoObject", "", 20, 20), 0.5f, 0.03) << "half of the pixel is sky";
  EXPECT_NEAR(coverage(image, "CryptoMaterial", "gum", 20, 20), 0.5f, 0.03) << "both have the one material";
  EXPECT_EQ(coverage(image, "CryptoObject", "left", 20, 6), 1);
  EXPECT_EQ(coverage(image, "CryptoMaterial", "wax", 20, 6), 1);
  EXPECT_EQ(coverage(image, "CryptoObject", "", 2, 38), 0);
}

TEST(IdChannels, TheGroundIsAnObjectOfThatName) {
  Scene scene = scene_from_above();
  scene.ground.emplace();
  const Image image = rendered(scene, with({PictureChannel::ObjectId}));
  EXPECT_EQ(coverage(image, "CryptoObject", "ground", 20, 20), 1);
}

TEST(IdChannels, TellTheGroundFromABodyOfThatName) {
  Scene scene = scene_from_above();
  scene.ground.emplace();
  scene.meshes = {square(0.25f, 0.1f, matte(0.5f))};
  scene.meshes[0].name = scene.meshes[0].material = "ground";
  const Image image = rendered(scene, with({PictureChannel::ObjectId, PictureChannel::MaterialId}));
  for (const char* plane : {"CryptoObject", "CryptoMaterial"}) {
    EXPECT_EQ(coverage(image, plane, "ground", 20, 20), 1);
    EXPECT_EQ(coverage(image, plane, "ground", 2, 2), 0);
    EXPECT_EQ(coverage(image, plane, "ground_2", 2, 2), 1);
  }
}

TEST(Channels, OfSamplesAloneGatherNothing) {
  const Scene scene = scene_from_above();
  const Picture picture;
  const auto gathers = [&](std::initializer_list<PictureChannel> channels) {
    return ChannelLayout(scene, picture, with(channels).channels, 8, 8).gathers();
  };
  EXPECT_FALSE(gathers({}));
  EXPECT_FALSE(gathers({PictureChannel::Samples}));
  EXPECT_TRUE(gathers({PictureChannel::Samples, PictureChannel::Depth}));
  EXPECT_TRUE(gathers({PictureChannel::ObjectId}));
  EXPECT_EQ(value(rendered(scene, with({PictureChannel::Samples})), "samples.N", 3, 3), 8);
}

TEST(Channels, DoNotTouchTheColour) {
  Scene scene = scene_from_above();
  scene.meshes = {sphere(Vec3f(0, 0.3f, 0), 0.5f, matte(0.5f))};
  const Image plain = rendered(scene, with({}));
  scene.meshes[0].next_positions = moved(scene.meshes[0].times[0].positions, Vec3f(1, 1, 1));
  const Image full = rendered(
      scene, with({PictureChannel::Albedo, PictureChannel::Motion, PictureChannel::ObjectId, PictureChannel::Samples}));
  for (const char* name : {"R", "G", "B"}) EXPECT_EQ(plain.find(name)->pixels, full.find(name)->pixels);
  EXPECT_EQ(value(full, "samples.N", 3, 3), 8);
}

}  // namespace
}  // namespace softreel
