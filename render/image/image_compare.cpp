#include "render/image/image_compare.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace softreel {

namespace {

constexpr int kBlock = 8;

std::size_t value_index(const DisplayImage& image, int x, int y, int channel) {
  return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)) +
         static_cast<std::size_t>(channel);
}

int difference_at(const DisplayImage& a, const DisplayImage& b, std::size_t k) {
  return static_cast<int>(a.pixels[k]) - static_cast<int>(b.pixels[k]);
}

/// The largest of the three channels' mean differences over one block; noise of both signs cancels.
double block_error_at(const DisplayImage& a, const DisplayImage& b, int x0, int y0) {
  const int x1 = std::min(x0 + kBlock, a.width), y1 = std::min(y0 + kBlock, a.height);
  double largest = 0;
  for (int channel = 0; channel < 3; ++channel) {
    int sum = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) sum += difference_at(a, b, value_index(a, x, y, channel));
    largest = std::max(largest, std::abs(sum) / (255.0 * (x1 - x0) * (y1 - y0)));
  }
  return largest;
}

}  // namespace

ImageDifference compare(const DisplayImage& a, const DisplayImage& b) {
  ImageDifference result;
  result.same_size = a.width == b.width && a.height == b.height;
  result.identical = result.same_size && a.pixels == b.pixels;
  if (!result.same_size || result.identical) return result;
  double squares = 0;
  int largest = 0;
  for (std::size_t k = 0; k < a.pixels.size(); ++k) {
    const int d = difference_at(a, b, k);
    squares += static_cast<double>(d) * d;
    largest = std::max(largest, std::abs(d));
  }
  result.rmse = std::sqrt(squares / static_cast<double>(a.pixels.size())) / 255;
  result.max_error = largest / 255.0;
  for (int y = 0; y < a.height; y += kBlock)
    for (int x = 0; x < a.width; x += kBlock) {
      const double error = block_error_at(a, b, x, y);
      if (error <= result.block_error) continue;
      result.block_error = error;
      result.worst_x = x;
      result.worst_y = y;
    }
  return result;
}

}  // namespace softreel
