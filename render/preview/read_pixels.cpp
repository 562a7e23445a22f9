#include "render/preview/read_pixels.h"

#include <algorithm>

namespace softreel {
namespace {

/// Calls take(from, to) with the first byte of each row and the number of the row's first pixel in the picture.
template <typename Take>
void for_rows(const std::vector<std::uint8_t>& pixels, int width, int height, const Take& take) {
  const auto row = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  for (std::size_t y = 0; y < rows; ++y) take(&pixels[4 * row * (rows - 1 - y)], row * y);
}

}  // namespace

DisplayImage opaque_picture(const std::vector<std::uint8_t>& pixels, int width, int height) {
  DisplayImage image{width, height, std::vector<std::uint8_t>(pixels.size() / 4 * 3)};
  for_rows(pixels, width, height, [&](const std::uint8_t* from, std::size_t first) {
    std::uint8_t* to = &image.pixels[3 * first];
    for (int x = 0; x < width; ++x, from += 4, to += 3) {
      to[0] = from[0];
      to[1] = from[1];
      to[2] = from[2];
    }
  });
  return image;
}

DisplayImage transparent_picture(const std::vector<std::uint8_t>& pixels, int width, int height) {
  DisplayImage image = opaque_picture(pixels, width, height);
  image.alpha.resize(pixels.size() / 4);
  for_rows(pixels, width, height, [&](const std::uint8_t* from, std::size_t first) {
    for (std::size_t k = first; k < first + static_cast<std::size_t>(width); ++k, from += 4) {
      image.alpha[k] = from[3];
      if (from[3] == 0) continue;
      for (std::size_t c = 0; c < 3; ++c)
        image.pixels[3 * k + c] = static_cast<std::uint8_t>(std::min(255, (255 * from[c] + from[3] / 2) / from[3]));
    }
  });
  return image;
}

}  // namespace softreel
