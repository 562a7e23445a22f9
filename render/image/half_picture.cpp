#include "render/image/half_picture.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <half.h>

#include "core/base/check.h"
#include "core/base/error.h"

namespace softreel {
namespace {

constexpr std::array<const char*, 3> kNames{"R", "G", "B"};

struct Header {
  char magic[8] = {'h', 'a', 'l', 'f', ' ', 'R', 'G', 'B'};
  std::int32_t width = 0, height = 0;
};

std::size_t plane_size(const Header& header) {
  return static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
}

}  // namespace

std::vector<std::uint8_t> encode_half(const Image& image) {
  Header header;
  header.width = image.width;
  header.height = image.height;
  std::vector<std::uint8_t> bytes(sizeof header + 3 * plane_size(header) * sizeof(Imath::half));
  std::memcpy(bytes.data(), &header, sizeof header);
  std::uint8_t* at = bytes.data() + sizeof header;
  for (const char* name : kNames) {
    const Channel* channel = image.find(name);
    CHECK(channel != nullptr);
    for (const float value : channel->pixels) {
      const Imath::half rounded(std::min(value, static_cast<float>(HALF_MAX)));
      const std::uint16_t bits = rounded.bits();
      std::memcpy(at, &bits, sizeof bits);
      at += sizeof bits;
    }
  }
  return bytes;
}

Image decode_half(const std::vector<std::uint8_t>& bytes) {
  Header header;
  const Header expected;
  if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  if (bytes.size() < sizeof header || std::memcmp(header.magic, expected.magic, sizeof header.magic) != 0 ||
      header.width <= 0 || header.height <= 0 ||
      bytes.size() != sizeof header + 3 * plane_size(header) * sizeof(std::uint16_t))
    throw work_error("a stored scene-linear picture has another format");
  Image image{header.width, header.height, {}};
  const std::uint8_t* at = bytes.data() + sizeof header;
  for (const char* name : kNames) {
    Channel& channel = image.channels.emplace_back(Channel{name, {}});
    channel.pixels.resize(plane_size(header));
    for (float& value : channel.pixels) {
      std::uint16_t bits = 0;
      std::memcpy(&bits, at, sizeof bits);
      Imath::half half;
      half.setBits(bits);
      value = half;
      at += sizeof bits;
    }
  }
  return image;
}

}  // namespace softreel
