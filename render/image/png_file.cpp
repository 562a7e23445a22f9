#include "render/image/png_file.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <zlib.h>

#include "core/base/check.h"
#include "core/base/error.h"

namespace softreel {
namespace {

/// Bytes of pixels in a strip, about: enough that what deflate forgets at its start does not count.
constexpr std::size_t kStrip = 1 << 18;
/// The least effort. Noise of a traced picture compresses little: at level 3 it took 1.7 times as long, and was larger.
constexpr int kLevel = Z_BEST_SPEED;

constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::uint8_t kPerceptual = 0;                                                  ///< rendering intent
constexpr std::array<std::uint8_t, 8> kLinear = {'g', 'A', 'M', 'A', 0, 1, 0x86, 0xa0};  ///< of 1
constexpr std::array<std::uint8_t, 2> kZlibHeader = {0x78, 0x01};  ///< window of 32 kB, quick compression

struct Strip {
  std::vector<std::uint8_t> bytes;  ///< of the deflate stream
  uLong checksum = 0;               ///< Adler-32 of what was compressed
  std::size_t size = 0;             ///< bytes of what was compressed
};

[[noreturn]] void fail(int code) {
  throw work_error(fmt::format("Compressing a PNG failed: zlib's error {}.\n  Free some memory and run again.", code));
}

/// deflateEnd, however the strip ends.
class Deflater {
 public:
  Deflater() {
    const int code = deflateInit2(&stream_, kLevel, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY);  // negative: no header
    if (code != Z_OK) fail(code);
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  /// The strip's part of the stream: ends on a byte, and refers to nothing before it.
  std::vector<std::uint8_t> compress(std::vector<std::uint8_t>& from, bool is_last) {
    std::vector<std::uint8_t> to(deflateBound(&stream_, static_cast<uLong>(from.size())) + 16);
    stream_.next_in = from.data();
    stream_.avail_in = static_cast<uInt>(from.size());
    stream_.next_out = to.data();
    stream_.avail_out = static_cast<uInt>(to.size());
    const int code = deflate(&stream_, is_last ? Z_FINISH : Z_SYNC_FLUSH);
    if (code != (is_last ? Z_STREAM_END : Z_OK) || stream_.avail_in != 0) fail(code);
    to.resize(stream_.total_out);
    return to;
  }

 private:
  z_stream stream_{};
};

/// Rows with the byte of their filter before each: none, which suits noise.
std::vector<std::uint8_t> filtered_rows(std::span<const std::uint8_t> pixels, std::size_t row) {
  std::vector<std::uint8_t> rows(pixels.size() + pixels.size() / row, 0);
  for (std::size_t from = 0, to = 1; from < pixels.size(); from += row, to += row + 1)
    std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(from), row,
                rows.begin() + static_cast<std::ptrdiff_t>(to));
  return rows;
}

Strip compressed(std::span<const std::uint8_t> pixels, std::size_t row, bool is_last) {
  std::vector<std::uint8_t> rows = filtered_rows(pixels, row);
  Strip strip;
  strip.size = rows.size();
  strip.checksum = adler32(1, rows.data(), static_cast<uInt>(rows.size()));
  strip.bytes = Deflater().compress(rows, is_last);
  return strip;
}

void add_number(std::vector<std::uint8_t>& to, std::uint64_t value) {
  for (const int shift : {24, 16, 8, 0}) to.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// Length, name, content, CRC of the last two.
void add_chunk(std::vector<std::uint8_t>& file, std::string_view name, std::span<const std::uint8_t> content) {
  CHECK(content.size() < std::size_t{1} << 31);
  add_number(file, content.size());
  const std::size_t start = file.size();
  file.insert(file.end(), name.begin(), name.end());
  file.insert(file.end(), content.begin(), content.end());
  add_number(file, crc32(0, file.data() + start, static_cast<uInt>(file.size() - start)));
}

std::vector<std::uint8_t> image_header(int width, int height, int components) {
  std::vector<std::uint8_t> header;
  add_number(header, static_cast<std::uint64_t>(width));
  add_number(header, static_cast<std::uint64_t>(height));
  const std::uint8_t color = components == 4 ? 6 : 2;
  for (const std::uint8_t value : {std::uint8_t{8}, color, std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}})
    header.push_back(value);  // bits a value, colours, compression, filters, interlacing
  return header;
}

/// One zlib stream, a chunk for each strip.
void add_data(std::vector<std::uint8_t>& file, std::vector<Strip>& strips) {
  strips.front().bytes.insert(strips.front().bytes.begin(), kZlibHeader.begin(), kZlibHeader.end());
  uLong checksum = 1;
  for (const Strip& strip : strips)
    checksum = adler32_combine(checksum, strip.checksum, static_cast<z_off_t>(strip.size));
  add_number(strips.back().bytes, checksum);
  for (const Strip& strip : strips) add_chunk(file, "IDAT", strip.bytes);
}

}  // namespace

std::vector<std::uint8_t> png_file(int width, int height, int components, std::span<const std::uint8_t> pixels,
                                   PngValues values, const Threads* threads) {
  CHECK(components >= 3);
  CHECK(components <= 4);
  const std::size_t row = static_cast<std::size_t>(width) * static_cast<std::size_t>(components);
  CHECK(pixels.size() == row * static_cast<std::size_t>(height));
  const auto rows = static_cast<std::int64_t>(std::max<std::size_t>(1, kStrip / row));
  std::vector<Strip> strips(static_cast<std::size_t>((height + rows - 1) / rows));
  const auto compress_rows = [&](std::int64_t begin, std::int64_t end) {
    const std::span part =
        pixels.subspan(static_cast<std::size_t>(begin) * row, static_cast<std::size_t>(end - begin) * row);
    strips[static_cast<std::size_t>(begin / rows)] = compressed(part, row, end == height);
  };
  if (threads != nullptr) {
    threads->for_chunks(height, rows, compress_rows);
  } else {
    for (std::int64_t begin = 0; begin < height; begin += rows)
      compress_rows(begin, std::min<std::int64_t>(begin + rows, height));
  }
  std::vector<std::uint8_t> file(kSignature.begin(), kSignature.end());
  add_chunk(file, "IHDR", image_header(width, height, components));
  if (values == PngValues::Srgb)
    add_chunk(file, "sRGB", std::array{kPerceptual});
  else
    add_chunk(file, "gAMA", std::span(kLinear).subspan<4>());
  add_data(file, strips);
  add_chunk(file, "IEND", {});
  return file;
}

bool is_linear_png(std::span<const std::uint8_t> beginning) {
  constexpr std::size_t kHeader = 13, kName = kSignature.size() + 12 + kHeader + 4;  // length, name and CRC: 12
  return beginning.size() >= kName + kLinear.size() &&
         std::equal(kSignature.begin(), kSignature.end(), beginning.begin()) &&
         std::equal(kLinear.begin(), kLinear.end(), beginning.begin() + kName);
}

}  // namespace softreel
