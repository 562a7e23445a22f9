#include "render/image/flip.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "render/image/flip_color.h"

namespace softreel {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// One plane of three channels.
struct Plane {
  int width = 0, height = 0;
  std::vector<Vec3f> pixels;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

Plane opponent_plane(const DisplayImage& image) {
  Plane plane{image.width, image.height, {}};
  plane.pixels.reserve(image.pixels.size() / 3);
  for (std::size_t k = 0; k < image.pixels.size(); k += 3)
    plane.pixels.push_back(flip_opponent(decoded(&image.pixels[k])));
  return plane;
}

/// Weights at -radius .. radius.
using Kernel = std::vector<float>;

/// Convolves rows, then columns; each channel with its own kernel. Beyond the border lies the border's pixel.
Plane convolve(const Plane& in, const std::array<Kernel, 3>& across, const std::array<Kernel, 3>& down) {
  const auto pass = [](const Plane& from, const std::array<Kernel, 3>& kernels, int dx, int dy) {
    Plane to{from.width, from.height, std::vector<Vec3f>(from.pixels.size())};
    for (int c = 0; c < 3; ++c) {
      const Kernel& kernel = kernels[static_cast<std::size_t>(c)];
      const int radius = static_cast<int>(kernel.size() / 2);
      for (int y = 0; y < from.height; ++y)
        for (int x = 0; x < from.width; ++x) {
          float sum = 0;
          for (int k = -radius; k <= radius; ++k) {
            const int sx = std::clamp(x + k * dx, 0, from.width - 1), sy = std::clamp(y + k * dy, 0, from.height - 1);
            sum += kernel[static_cast<std::size_t>(k + radius)] * from.pixels[from.index(sx, sy)][c];
          }
          to.pixels[to.index(x, y)][c] = sum;
        }
    }
    return to;
  };
  return pass(pass(in, across, 1, 0), down, 0, 1);
}

// ---- the colour pipeline, sec. 4.1
// -----------------------------------------------------------------------------------

/// A contrast sensitivity function in space: a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees; table 1.
struct Sensitivity {
  float a, b;
};
constexpr Sensitivity kAchromatic{1, 0.0047f}, kRedGreen{1, 0.0053f};
constexpr std::array<Sensitivity, 2> kBlueYellow{{{34.1f, 0.04f}, {13.5f, 0.025f}}};

int sensitivity_radius(float pixels_per_degree) {
  const float widest = kBlueYellow[0].b;
  return static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * kPi * kPi)) * pixels_per_degree));
}

/// Along one axis, with sum 1.
Kernel gaussian(const Sensitivity& s, int radius, float pixels_per_degree) {
  Kernel kernel;
  float sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    const float x = static_cast<float>(k) / pixels_per_degree;
    kernel.push_back(std::exp(-kPi * kPi * x * x / s.b));
    sum += kernel.back();
  }
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

/// Share of a Gaussian in the two-dimensional sum of several: a sqrt(pi / b) times its own sum.
float weight_of(const Sensitivity& s, int radius, float pixels_per_degree) {
  float sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    const float x = static_cast<float>(k) / pixels_per_degree;
    sum += std::exp(-kPi * kPi * x * x / s.b);
  }
  return s.a * std::sqrt(kPi / s.b) * sum * sum;
}

/// What the eye makes of a picture at that distance. The blue-yellow sensitivity is a sum of two Gaussians, each of
/// which is convolved along rows and columns.
Plane seen(const Plane& opponent, float pixels_per_degree) {
  const int radius = sensitivity_radius(pixels_per_degree);
  const auto kernel = [&](const Sensitivity& s) { return gaussian(s, radius, pixels_per_degree); };
  const std::array<Kernel, 3> wide{kernel(kAchromatic), kernel(kRedGreen), kernel(kBlueYellow[0])};
  const std::array<Kernel, 3> narrow{Kernel{1}, Kernel{1}, kernel(kBlueYellow[1])};
  Plane out = convolve(opponent, wide, wide);
  const Plane second = convolve(opponent, narrow, narrow);
  const float w0 = weight_of(kBlueYellow[0], radius, pixels_per_degree);
  const float w1 = weight_of(kBlueYellow[1], radius, pixels_per_degree);
  for (std::size_t k = 0; k < out.pixels.size(); ++k)
    out.pixels[k].z() = (w0 * out.pixels[k].z() + w1 * second.pixels[k].z()) / (w0 + w1);
  return out;
}

/// Eq. (5): most of the range for errors that are likely, the rest for those up to green against blue.
float redistributed(float error) {
  constexpr float kExponent = 0.7f, kShare = 0.4f, kRange = 0.95f;
  static const float largest = std::pow(hyab_distance(flip_lab(Vec3f::UnitY()), flip_lab(Vec3f::UnitZ())), kExponent);
  const float powered = std::pow(error, kExponent), knee = kShare * largest;
  if (powered < knee) return kRange * powered / knee;
  return kRange + (1 - kRange) * (powered - knee) / (largest - knee);
}

// ---- the feature pipeline, sec. 4.2
// ----------------------------------------------------------------------------------

/// The Gaussian and its first or second derivative along one axis; positive weights sum to 1, negative ones to -1.
struct FeatureKernels {
  Kernel smooth, edge, point;
};

void balance(Kernel& kernel) {
  float above = 0, below = 0;
  for (const float weight : kernel) (weight > 0 ? above : below) += weight;
  for (float& weight : kernel) weight /= weight > 0 ? above : -below;
}

FeatureKernels feature_kernels(float pixels_per_degree) {
  constexpr float kWidth = 0.082f;  // degrees, of the features the eye tells apart
  const float deviation = 0.5f * kWidth * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  FeatureKernels kernels;
  float sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    const float x = static_cast<float>(k), u = x / deviation;
    const float g = std::exp(-0.5f * u * u);
    kernels.smooth.push_back(g);
    kernels.edge.push_back(-x * g);
    kernels.point.push_back((u * u - 1) * g);
    sum += g;
  }
  for (float& weight : kernels.smooth) weight /= sum;
  balance(kernels.edge);
  balance(kernels.point);
  return kernels;
}

/// Strength of edges and of points (and lines) per pixel, of the luminance alone.
struct Features {
  std::vector<float> edges, points;
};

Features features_of(const Plane& opponent, const FeatureKernels& kernels) {
  Plane luminance{opponent.width, opponent.height, {}};
  // Twice the same channel: x and y derivatives come of one pass each.
  for (const Vec3f& pixel : opponent.pixels) luminance.pixels.push_back(Vec3f::Constant((pixel.x() + 16) / 116));
  const Plane edge =
      convolve(luminance, {kernels.edge, kernels.smooth, Kernel{0}}, {kernels.smooth, kernels.edge, Kernel{0}});
  const Plane point =
      convolve(luminance, {kernels.point, kernels.smooth, Kernel{0}}, {kernels.smooth, kernels.point, Kernel{0}});
  Features features;
  for (std::size_t k = 0; k < edge.pixels.size(); ++k) {
    features.edges.push_back(edge.pixels[k].head<2>().norm());
    features.points.push_back(point.pixels[k].head<2>().norm());
  }
  return features;
}

}  // namespace

FlipMap flip(const DisplayImage& a, const DisplayImage& b, float pixels_per_degree) {
  CHECK(a.width == b.width);
  CHECK(a.height == b.height);
  CHECK(pixels_per_degree > 0);
  const Plane opponent_a = opponent_plane(a), opponent_b = opponent_plane(b);
  const Plane seen_a = seen(opponent_a, pixels_per_degree), seen_b = seen(opponent_b, pixels_per_degree);
  const FeatureKernels kernels = feature_kernels(pixels_per_degree);
  const Features features_a = features_of(opponent_a, kernels), features_b = features_of(opponent_b, kernels);
  FlipMap map{a.width, a.height, std::vector<float>(opponent_a.pixels.size())};
  for (std::size_t k = 0; k < map.errors.size(); ++k) {
    const float color =
        redistributed(hyab_distance(flip_lab(linear_of(seen_a.pixels[k])), flip_lab(linear_of(seen_b.pixels[k]))));
    const float feature = std::max(std::abs(features_a.edges[k] - features_b.edges[k]),
                                   std::abs(features_a.points[k] - features_b.points[k]));
    // Sec. 4.2 and 4.3: (feature / sqrt 2)^0.5 raises the colour's error.
    map.errors[k] = std::pow(color, 1 - std::sqrt(feature / std::numbers::sqrt2_v<float>));
  }
  return map;
}

FlipSummary summarize(const FlipMap& map) {
  FlipSummary summary;
  double total = 0;
  for (int y0 = 0; y0 < map.height; y0 += kFlipBlock)
    for (int x0 = 0; x0 < map.width; x0 += kFlipBlock) {
      const int x1 = std::min(x0 + kFlipBlock, map.width), y1 = std::min(y0 + kFlipBlock, map.height);
      double sum = 0;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
          sum += static_cast<double>(map.errors[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                                                static_cast<std::size_t>(x)]);
      total += sum;
      // A block cut off by the border counts as if the rest of it were the same: it must not look worse than a whole
      // one.
      const double mean = sum / (kFlipBlock * kFlipBlock);
      if (mean <= summary.worst_block) continue;
      summary.worst_block = mean;
      summary.worst_x = x0;
      summary.worst_y = y0;
    }
  summary.mean = total / static_cast<double>(map.errors.size());
  return summary;
}

Vec3f magma(float share) {
  const float t = std::clamp(share, 0.0f, 1.0f);
  const std::array<Vec3f, 7> c = {
      Vec3f(-0.002136485f, -0.000749655f, -0.005386128f), Vec3f(0.251660541f, 0.677523244f, 2.494026599f),
      Vec3f(8.353717279f, -3.577719515f, 0.314467903f),   Vec3f(-27.66873309f, 14.26473078f, -13.64921319f),
      Vec3f(52.17613981f, -27.94360607f, 12.94416944f),   Vec3f(-50.76852536f, 29.04658283f, 4.234152993f),
      Vec3f(18.65570507f, -11.48977352f, -5.601961509f)};
  Vec3f value = c[6];
  for (std::size_t k = 6; k-- > 0;) value = c[k] + t * value;
  return value.cwiseMax(0.0f).cwiseMin(1.0f);
}

DisplayImage flip_picture(const FlipMap& map) {
  DisplayImage out{map.width, map.height, {}};
  out.pixels.reserve(3 * map.errors.size());
  for (const float error : map.errors) {
    const Vec3f color = magma(error);
    for (int k = 0; k < 3; ++k) out.pixels.push_back(static_cast<std::uint8_t>(std::lround(255 * color[k])));
  }
  return out;
}

}  // namespace softreel
