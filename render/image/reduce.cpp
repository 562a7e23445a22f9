#include "render/image/reduce.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "render/image/view_transform.h"

namespace softreel {
namespace {

const std::array<float, 256>& decoded_codes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = srgb_decode(static_cast<float>(k) / 255);
    return values;
  }();
  return table;
}

/// Pixels [first, first + weights.size()) of a line and how much of each an output pixel covers; sum 1.
struct Coverage {
  int first = 0;
  std::vector<float> weights;
};

std::vector<Coverage> coverages(int from, int to) {
  std::vector<Coverage> result;
  const double step = static_cast<double>(from) / to;
  for (int k = 0; k < to; ++k) {
    const double begin = k * step, end = (k + 1) * step;
    Coverage one{static_cast<int>(begin), {}};
    for (int p = one.first; p < from && p < end; ++p)
      one.weights.push_back(static_cast<float>((std::min(end, p + 1.0) - std::max(begin, 1.0 * p)) / step));
    result.push_back(std::move(one));
  }
  return result;
}

}  // namespace

DisplayImage reduced(const DisplayImage& image, int width) {
  CHECK(width > 0);
  if (width >= image.width) return image;
  const int height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(image.height) * width / image.width)));
  const std::vector<Coverage> columns = coverages(image.width, width), rows = coverages(image.height, height);
  DisplayImage out{width, height, {}};
  out.pixels.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (const Coverage& row : rows)
    for (const Coverage& column : columns) {
      Vec3f sum = Vec3f::Zero();
      for (std::size_t j = 0; j < row.weights.size(); ++j)
        for (std::size_t i = 0; i < column.weights.size(); ++i) {
          const std::size_t at =
              3 * ((static_cast<std::size_t>(row.first) + j) * static_cast<std::size_t>(image.width) +
                   static_cast<std::size_t>(column.first) + i);
          for (int c = 0; c < 3; ++c)
            sum[c] +=
                row.weights[j] * column.weights[i] * decoded_codes()[image.pixels[at + static_cast<std::size_t>(c)]];
        }
      for (int c = 0; c < 3; ++c)
        out.pixels.push_back(static_cast<std::uint8_t>(std::lround(255 * srgb_encode(sum[c]))));
    }
  return out;
}

}  // namespace softreel
