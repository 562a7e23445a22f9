// The reader of Radiance pictures; those of other formats are libraries.
#include <cmath>

#include "core/base/check.h"
#include "core/base/error.h"
#include "render/image/radiance_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace softreel::fuzz {

std::vector<std::string> seeds() {
  using namespace std::string_literals;
  const std::string header = "\0#?RADIANCE\n# by hand\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 9\n"s;
  const std::string pixel = "\200\100\40\202"s;
  std::string flat;
  for (int k = 0; k < 18; ++k) flat += pixel;
  const std::string row_of_runs = pixel + "\1\1\1\6"s + pixel + pixel;
  const std::string coded_row =
      "\2\2\0\11"s + "\211\200"s + "\4abcd\205\7"s + "\11"s + "123456789"s + "\210\202\1\201"s;
  return {header + flat, header + row_of_runs + row_of_runs, header + coded_row + coded_row};
}

}  // namespace softreel::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softreel;
  return fuzz::run_input(data, size, [](std::uint8_t, std::string_view bytes) {
    const EnvironmentImage image = decode_radiance("fuzz", bytes);
    CHECK(image.width > 0);
    CHECK(image.height > 0);
    CHECK(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    for (const Vec3f& pixel : image.pixels) CHECK(pixel.allFinite());
  });
}
