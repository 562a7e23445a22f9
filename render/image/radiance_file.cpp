// After Ward, Real Pixels, Graphics Gems II, 1991, and the Radiance file formats: a header of lines, the size, then
// rows of pixels of four bytes. Rows are flat; or flat with runs of equal pixels; or, by component, runs and stretches
// of bytes.
#include "render/image/radiance_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "render/image/unreadable_picture.h"

namespace softreel {
namespace {

constexpr int kMostPixelsAcross = 1 << 16;
constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 20;        // of a file whose size alone is wanted
constexpr std::size_t kMostRadiancePixels = std::size_t{1} << 28;     // as of an EXR
constexpr std::size_t kLeastCodedWidth = 8, kMostCodedWidth = 32767;  // of rows coded by component
constexpr std::size_t kMostPixelsPerByte = 16;  // of such a row: two bytes a run of at most 127, four components

using Rgbe = std::array<std::uint8_t, 4>;  ///< red, green, blue, exponent

Vec3f color_of(const Rgbe& pixel) {
  if (pixel[3] == 0) return Vec3f::Zero();
  return std::ldexp(1.0f, pixel[3] - 136) * Vec3f(pixel[0], pixel[1], pixel[2]);
}

class RadianceReader {
 public:
  RadianceReader(const std::string& path, std::string_view bytes) : path_(path), left_(bytes) {}

  std::pair<int, int> read_size() {
    read_header();
    return size(line());
  }

  EnvironmentImage read() {
    EnvironmentImage image{0, 0, {}};
    std::tie(image.width, image.height) = read_size();
    const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    image.pixels.reserve(std::min(pixels, kMostPixelsPerByte * left_.size()));
    row_.reserve(static_cast<std::size_t>(image.width));
    for (int y = 0; y < image.height; ++y) {
      read_row(static_cast<std::size_t>(image.width));
      for (const Rgbe& pixel : row_) image.pixels.push_back(color_of(pixel));
    }
    return image;
  }

 private:
  Error refusal(const std::string& reason) const {
    return unreadable_picture(
        path_, reason,
        fmt::format("a complete Radiance HDR picture of FORMAT=32-bit_rle_rgbe with rows from the upper left ('-Y "
                    "height +X width'), at most {} pixels a side and {} million in all",
                    kMostPixelsAcross, kMostRadiancePixels / 1000000));
  }

  std::string_view line() {
    const std::size_t end = left_.find('\n');
    if (end == std::string_view::npos) throw refusal("it ends in its header");
    const std::string_view text = left_.substr(0, end);
    left_.remove_prefix(end + 1);
    return text;
  }

  /// Up to the empty line. Whatever else it tells, as the exposure, leaves the numbers as they are.
  void read_header() {
    if (!left_.starts_with("#?RADIANCE\n") && !left_.starts_with("#?RGBE\n"))
      throw refusal("it does not begin as a Radiance HDR picture does ('#?RADIANCE' or '#?RGBE')");
    bool has_format = false;
    for (std::string_view text = line(); !text.empty(); text = line()) {
      if (text == "FORMAT=32-bit_rle_xyze") throw refusal("its colours are XYZ (FORMAT=32-bit_rle_xyze), not RGB");
      has_format = has_format || text == "FORMAT=32-bit_rle_rgbe";
    }
    if (!has_format) throw refusal("its header names no FORMAT=32-bit_rle_rgbe");
  }

  /// Width and height from '-Y height +X width'.
  std::pair<int, int> size(std::string_view text) const {
    const int height = extent(text, "-Y "), width = extent(text, "+X ");
    if (text.find_first_not_of(' ') != std::string_view::npos) throw refusal("its size is followed by something else");
    if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > kMostRadiancePixels)
      throw refusal(fmt::format("it claims to have {} x {} pixels", width, height));
    return {width, height};
  }

  /// Takes an axis and a number off the text.
  int extent(std::string_view& text, std::string_view axis) const {
    constexpr const char* kSpace = " ";
    text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
    if (!text.starts_with(axis)) throw refusal("its size is not written as '-Y height +X width'");
    text.remove_prefix(axis.size());
    text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
    int number = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (status != std::errc() || number < 1 || number > kMostPixelsAcross)
      throw refusal(fmt::format("its size has no number from 1 to {} after '{}'", kMostPixelsAcross, axis));
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return number;
  }

  std::string_view take(std::size_t count) {
    if (count > left_.size()) throw refusal("it ends before its last pixel");
    const std::string_view taken = left_.substr(0, count);
    left_.remove_prefix(count);
    return taken;
  }
  std::uint8_t byte() { return static_cast<std::uint8_t>(take(1).front()); }

  /// Each row tells its own coding.
  void read_row(std::size_t width) {
    row_.clear();
    const bool may_be_coded = width >= kLeastCodedWidth && width <= kMostCodedWidth && left_.size() >= 4;
    if (!may_be_coded || left_[0] != 2 || left_[1] != 2 || (left_[2] & 0x80) != 0) return read_pixels(width);
    take(2);
    const auto high = static_cast<std::size_t>(byte()), low = static_cast<std::size_t>(byte());
    if ((high << 8 | low) != width) throw refusal("a row has another number of pixels than the picture is wide");
    row_.resize(width);
    for (std::size_t c = 0; c < 4; ++c) read_component(c);
  }

  /// Above 128: a run of so many less 128; else so many bytes as they are.
  void read_component(std::size_t c) {
    for (std::size_t x = 0; x < row_.size();) {
      const std::uint8_t code = byte();
      const bool is_run = code > 128;
      const std::size_t count = is_run ? code - 128U : code;
      if (count == 0) throw refusal("a run has no pixels");
      if (count > row_.size() - x) throw overlong();
      const std::string_view values = take(is_run ? 1 : count);
      for (std::size_t k = 0; k < count; ++k) row_[x++][c] = static_cast<std::uint8_t>(values[is_run ? 0 : k]);
    }
  }

  /// Pixels as they are. (1, 1, 1, n) is none: n more of the pixel before; where such follow each other, the digits to
  /// base 256 of one number, from the lowest.
  void read_pixels(std::size_t width) {
    std::size_t digit = 1;
    while (row_.size() < width) {
      const std::string_view four = take(4);
      const auto at = [&](std::size_t c) { return static_cast<std::uint8_t>(four[c]); };
      if (at(0) != 1 || at(1) != 1 || at(2) != 1) {
        row_.push_back({at(0), at(1), at(2), at(3)});
        digit = 1;
        continue;
      }
      if (row_.empty()) throw refusal("a row begins with a run of the pixel before it");
      const std::size_t count = at(3) * digit;
      if (count > width - row_.size()) throw overlong();
      row_.insert(row_.end(), count, Rgbe(row_.back()));
      digit = std::min(digit << 8, std::size_t{1} << 24);  // a longer run fits no row
    }
  }

  Error overlong() const { return refusal("a run goes on beyond the end of its row"); }

  std::string path_;
  std::string_view left_;  ///< of the file
  std::vector<Rgbe> row_;
};

}  // namespace

EnvironmentImage decode_radiance(const std::string& path, std::string_view bytes) {
  return RadianceReader(path, bytes).read();
}

EnvironmentImage read_radiance(const std::string& path) {
  const std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file || !bytes) throw unreadable_picture(path, "it cannot be opened, or is empty", "a Radiance HDR picture");
  return decode_radiance(path, bytes.view());
}

std::pair<int, int> radiance_size(const std::string& path) {
  std::string beginning(kMostHeaderBytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  beginning.resize(static_cast<std::size_t>(file.gcount()));
  return RadianceReader(path, beginning).read_size();
}

}  // namespace softreel
