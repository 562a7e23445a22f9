// Pixels get the samples they need, and passes over a picture change no bit of it.
#include "render/pathtrace/adaptive_sampling.h"

#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "render/pathtrace/path_tracer.h"
#include "tests/render/test_scenes.h"

namespace softreel {
namespace {

/// Half smooth sky, half noisy soft shadow and indirect light.
Scene mixed_scene() {
  Scene scene = scene_in_sky(0.3f);
  scene.meshes = {square(4, 0, matte(0.7f)), sphere(Vec3f(0, 0.6f, 0), 0.5f, matte(0.7f))};
  AreaLight lamp;
  lamp.center = Vec3f(1, 3, 1);
  lamp.u = Vec3f(0, 0, 1);
  lamp.v = Vec3f(-1, 0, 0);
  lamp.radiance = Vec3f::Constant(5);
  lamp.visible = false;
  scene.area_lights = {lamp};
  scene.camera.position = Vec3f(0, 1.2f, 6);
  return scene;
}

/// Root of the mean squared difference on a screen, where light looks like its square root.
double screen_difference(const Image& a, const Image& b) {
  double sum = 0;
  const std::size_t pixels = a.channels[0].pixels.size();
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < pixels; ++k)
      sum += std::pow(std::sqrt(static_cast<double>(a.channels[c].pixels[k])) -
                          std::sqrt(static_cast<double>(b.channels[c].pixels[k])),
                      2);
  return std::sqrt(sum / (3.0 * static_cast<double>(pixels)));
}

double mean_samples(const Image& image) {
  return mean_of(*image.find("samples.N"));
}

TEST(AdaptiveSampling, MeetsItsTargetAndTakesFewerSamplesThanTheWholePictureWouldNeed) {
  const Image converged = rendered(mixed_scene(), small_params(32, 4096));
  RenderParams params = small_params(32, 1024);
  for (const float noise : {0.01f, 0.007f}) {
    params.noise = noise;
    const Image adaptive = rendered(mixed_scene(), params);
    const double error = screen_difference(adaptive, converged);
    EXPECT_LT(error, static_cast<double>(noise));
    EXPECT_GT(error, 0.2 * static_cast<double>(noise)) << "more than was asked for";
    const Channel& samples = *adaptive.find("samples.N");
    const auto [least, most] = std::minmax_element(samples.pixels.begin(), samples.pixels.end());
    EXPECT_EQ(*least, 16) << "sky";
    // As many samples everywhere as the noisiest pixel got is what the same promise costs without adaptivity.
    EXPECT_LT(mean_samples(adaptive), 0.7 * static_cast<double>(*most));
    const double bias = mean_of(adaptive.channels[1]) - mean_of(converged.channels[1]);
    EXPECT_NEAR(bias, 0, 0.002) << "stopping does not darken";
  }
}

TEST(AdaptiveSampling, EstimatesTheErrorOnTheSafeSideAndNotByMuch) {
  // Without a target that can be met, every pixel has all samples: the estimate beside the truth.
  const Image converged = rendered(mixed_scene(), small_params(24, 2048));
  const Image few = rendered(mixed_scene(), small_params(24, 64));
  const double truth = screen_difference(few, converged);
  float low = 0, high = 1;  // the noise at which half the pixels stop at 64
  for (int k = 0; k < 12; ++k) {
    RenderParams params = small_params(24, 72);
    params.min_samples = 64;
    params.noise = 0.5f * (low + high);
    (mean_samples(rendered(mixed_scene(), params)) < 68 ? high : low) = params.noise;
  }
  EXPECT_GT(static_cast<double>(high), 0.4 * truth);
  EXPECT_LT(static_cast<double>(high), 3 * truth);
}

TEST(AdaptiveSampling, SeesTheNoiseOfShadowsInTheAlpha) {
  Scene scene = mixed_scene();
  scene.meshes.erase(scene.meshes.begin());
  scene.ground.emplace();
  scene.ground->shadow_catcher = true;
  const Image converged = rendered(scene, small_params(24, 2048));
  RenderParams params = small_params(24, 1024);
  params.noise = 0.01f;
  const Image adaptive = rendered(scene, params);
  double sum = 0;
  const std::vector<float>&a = adaptive.find("A")->pixels, &b = converged.find("A")->pixels;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += std::pow(std::sqrt(1 - static_cast<double>(a[k])) - std::sqrt(1 - static_cast<double>(b[k])), 2);
  EXPECT_LT(std::sqrt(sum / static_cast<double>(a.size())), 0.012);
  EXPECT_GT(mean_samples(adaptive), 20) << "more than the least";
  EXPECT_LT(mean_samples(adaptive), 900);
}

TEST(AdaptiveSampling, GivesTheSameBitsWithOneAndFourThreads) {
  RenderParams params = small_params(48, 64);
  params.noise = 0.01f;
  const Image one = rendered(mixed_scene(), params, 1), four = rendered(mixed_scene(), params, 4);
  ASSERT_EQ(one.channels.size(), 4u);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(one.channels[c].pixels, four.channels[c].pixels);
}

TEST(AdaptiveSampling, PixelsHaveTheBitsOfThatManySamples) {
  RenderParams params = small_params(24, 40);
  params.noise = 0.01f;
  const Image passes = rendered(mixed_scene(), params);
  const std::vector<float>& samples = passes.find("samples.N")->pixels;
  std::map<float, int> pixels_of;
  for (const float count : samples) ++pixels_of[count];
  ASSERT_GE(pixels_of.size(), 2u);
  for (const auto& [count, pixels] : pixels_of) {
    const Image at_once = rendered(mixed_scene(), small_params(24, static_cast<int>(count)));
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < samples.size(); ++k)
        if (samples[k] == count) {
          ASSERT_EQ(passes.channels[c].pixels[k], at_once.channels[c].pixels[k]);
        }
  }
}

TEST(TimeLimit, EndsAfterAWholePassWithTheBitsOfThatManySamples) {
  RenderParams params = small_params(48, 1 << 20);
  params.time_limit = 0.05;
  const Image limited = rendered(mixed_scene(), params);
  const Channel& samples = *limited.find("samples.N");
  const float count = samples.pixels.front();
  EXPECT_GE(count, 1);
  EXPECT_LT(count, 1 << 20);
  for (const float value : samples.pixels) ASSERT_EQ(value, count);
  const Image expected = rendered(mixed_scene(), small_params(48, static_cast<int>(count)));
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(limited.channels[c].pixels, expected.channels[c].pixels);
}

TEST(TimeLimit, LeavesAPictureThatIsDoneEarlierAlone) {
  RenderParams params = small_params(16, 8);
  params.time_limit = 1e9;
  EXPECT_EQ(mean_samples(rendered(mixed_scene(), params)), 8);
}

TEST(SamplesAfterPass, GrowByAQuarterInWholeSteps) {
  EXPECT_EQ(samples_after_pass(16, 8, 1000), 24);
  EXPECT_EQ(samples_after_pass(64, 8, 1000), 80);
  EXPECT_EQ(samples_after_pass(1, 1, 1000), 2);
  EXPECT_EQ(samples_after_pass(96, 8, 100), 100);
  EXPECT_EQ(samples_after_pass(100, 8, 100), 100);
}

TEST(ScreenError, IsTheStandardErrorOfBatchesOverTwiceTheRootOfTheMean) {
  PixelSums pixel;
  // Four batches of 8 samples with the means 1, 3, 1, 3: mean 2, variance of a batch 4/3, of the mean 1/3.
  for (const double mean : {1.0, 3.0, 1.0, 3.0})
    for (std::size_t c = 0; c < 3; ++c) {
      pixel.values[c] += kBatch * mean;
      pixel.batch_squares[c] += std::pow(kBatch * mean, 2);
    }
  pixel.samples = 4 * kBatch;
  EXPECT_NEAR(squared_screen_error(pixel), 1.0 / 3 / (4 * 2), 1e-12);
  const std::vector<PixelSums> picture(36, pixel);
  const double error = std::sqrt(1.0 / 24);
  const auto count = [&](double noise) {
    const auto noisy = noisy_pixels(picture, 6, 6, noise);
    return std::accumulate(noisy.begin(), noisy.end(), 0);
  };
  EXPECT_EQ(count(1.01 * error), 0);
  EXPECT_EQ(count(0.99 * error), 36);
}

}  // namespace
}  // namespace softreel
