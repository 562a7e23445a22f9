// Blur follows the curve of the shutter, whoever moves: the body or the camera.
#include "render/pathtrace/rays/camera_rays.h"

#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

const std::vector<ShutterCurve> kCurves{{0, 0}, {0.5f, 0.5f}, {0.25f, 0.5f}, {1, 0}, {0, 0.3f}};

/// Light let in per time at time t, over its mean.
double density(const ShutterCurve& curve, double t) {
  const double a = static_cast<double>(curve.opening), c = static_cast<double>(curve.closing);
  const double opened = t < a ? t / a : 1, closed = t > 1 - c ? (1 - t) / c : 1;
  return std::min(opened, closed) / (1 - 0.5 * (a + c));
}

TEST(ShutterTime, IsDistributedAsTheCurve) {
  constexpr int kBins = 20, kSamples = 200000;
  for (const ShutterCurve& curve : kCurves) {
    std::vector<double> bins(kBins);
    for (int k = 0; k < kSamples; ++k) {
      const float t = shutter_time(curve, (static_cast<float>(k) + 0.5f) / kSamples);
      ASSERT_GE(t, 0);
      ASSERT_LE(t, 1);
      bins[static_cast<std::size_t>(std::min(static_cast<int>(t * kBins), kBins - 1))] += 1.0 * kBins / kSamples;
    }
    for (int b = 0; b < kBins; ++b) {
      double expected = 0;  // mean of the density over the bin; the curve's kinks are on bin edges
      for (int i = 0; i < 64; ++i) expected += density(curve, (b + (i + 0.5) / 64) / kBins) / 64;
      EXPECT_NEAR(bins[static_cast<std::size_t>(b)], expected, 0.01) << curve.opening << ", " << curve.closing;
    }
  }
}

TEST(ShutterTime, ABoxLeavesTheNumbersAsTheyAre) {
  for (const float u : {0.0f, 0.123f, 0.5f, 0x1.fffffep-1f}) EXPECT_EQ(shutter_time({}, u), u);
}

constexpr int kPixels = 64;

/// A bright strip, 1/16 of the picture wide, in front of black.
Scene strip_scene() {
  Appearance bright = matte(0);
  bright.emission = Vec3f::Ones();
  MotionMesh strip = square(1, 0, bright);
  for (Vec3f& p : strip.times[0].positions) p = Vec3f(p.x() / 32, 0, 4 * p.z());
  Scene scene = scene_in_sky(0);
  scene.meshes = {strip};
  scene.camera = camera_above(10, 1);
  return scene;
}

/// Mean of the rows.
std::vector<double> profile(const Scene& scene, int samples) {
  const Image image = rendered(scene, small_params(kPixels, samples));
  std::vector<double> columns(kPixels);
  for (std::size_t k = 0; k < image.channels[0].pixels.size(); ++k)
    columns[k % kPixels] += static_cast<double>(image.channels[0].pixels[k]) / kPixels;
  return columns;
}

/// What a strip of width 1/16 gives pixel `column` of the picture [-1/2, 1/2], as its middle goes from -3/8 to 3/8.
double expected_light(const ShutterCurve& curve, int column) {
  double sum = 0;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps, middle = -0.375 + 0.75 * t;
    const double left = static_cast<double>(column) / kPixels - 0.5, right = left + 1.0 / kPixels;
    const double covered = std::min(right, middle + 1.0 / 32) - std::max(left, middle - 1.0 / 32);
    sum += density(curve, t) * std::max(0.0, covered) * kPixels / kSteps;
  }
  return sum;
}

TEST(MotionBlur, AMovingStripShowsTheCurveOfTheShutter) {
  for (const ShutterCurve& curve : kCurves) {
    Scene scene = strip_scene();
    scene.shutter = curve;
    MotionMesh& strip = scene.meshes[0];
    strip.times.push_back(strip.times[0]);
    for (Vec3f& p : strip.times[0].positions) p.x() -= 0.375f;
    for (Vec3f& p : strip.times[1].positions) p.x() += 0.375f;
    const std::vector<double> columns = profile(scene, 64);
    for (int c = 0; c < kPixels; ++c)
      EXPECT_NEAR(columns[static_cast<std::size_t>(c)], expected_light(curve, c), 0.02) << c;
  }
}

TEST(MotionBlur, AMovingCameraBlursLikeAMovingBody) {
  for (const ShutterCurve& curve : kCurves) {
    Scene scene = strip_scene();
    scene.shutter = curve;
    scene.camera_motion.assign(3, scene.camera);
    for (const std::size_t k : {0u, 2u}) {  // sideways: the strip goes the other way
      const float shift = k == 0 ? 0.375f : -0.375f;
      scene.camera_motion[k].position.x() += shift;
      scene.camera_motion[k].target.x() += shift;
    }
    const std::vector<double> columns = profile(scene, 64);
    for (int c = 0; c < kPixels; ++c)
      EXPECT_NEAR(columns[static_cast<std::size_t>(c)], expected_light(curve, c), 0.02) << c;
  }
}

TEST(MotionBlur, MorePiecesFollowABentPath) {
  // Out to the right and back, in two pieces of equal time: the strip is never left of the middle.
  Scene scene = strip_scene();
  MotionMesh& strip = scene.meshes[0];
  strip.times.assign(3, strip.times[0]);
  for (Vec3f& p : strip.times[1].positions) p.x() += 0.375f;
  const std::vector<double> columns = profile(scene, 64);
  for (int c = 0; c < kPixels / 2 - 3; ++c) EXPECT_EQ(columns[static_cast<std::size_t>(c)], 0) << c;
  EXPECT_NEAR(columns[kPixels / 2 + 12], 1.0 / 16 / 0.375, 0.02) << "twice over the same way";
}

TEST(CameraRays, AStillCameraGivenTwiceIsTheSamePictureButForItsSamples) {
  Scene scene = strip_scene();
  const CameraRays one(scene, 8, 8);
  scene.camera_motion.assign(2, scene.camera);
  const CameraRays two(scene, 8, 8);
  const SampleBlock u{0.3f, 0.6f, 0.1f, 0.9f, 0.7f};
  EXPECT_TRUE(one.ray(3, 4, u).direction.isApprox(two.ray(3, 4, u).direction, 1e-6f));
  EXPECT_EQ(one.ray(3, 4, u).origin, two.ray(3, 4, u).origin);
}

TEST(CameraRays, ATurningCameraKeepsItsAngleOfView) {
  Scene scene = strip_scene();
  scene.camera.position = Vec3f(0, 1, 4);
  scene.camera.up = Vec3f(0, 1, 0);
  scene.camera.target = Vec3f(-4, 1, 0);
  scene.camera_motion = {scene.camera, scene.camera};
  scene.camera_motion[1].target = Vec3f(4, 1, 0);
  const CameraRays rays(scene, 100, 100);
  const auto at = [&](int x, float time) { return rays.ray(x, 50, {0, 0, 0, 0, time}).direction; };
  const float still = std::acos(at(0, 0).dot(at(100, 0)));
  EXPECT_NEAR(std::acos(at(0, 0.5f).dot(at(100, 0.5f))), still, 1e-4);
  EXPECT_TRUE(at(50, 0.5f).isApprox(Vec3f(0, 0, -1), 1e-4f)) << at(50, 0.5f).transpose();
}

}  // namespace
}  // namespace softreel
