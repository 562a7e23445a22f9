#include "render/image/half_picture.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <half.h>

#include "core/base/check.h"
#include "core/base/error.h"

namespace softreel {
namespace {

/// The alpha is stored if the picture has one.
constexpr std::array<const char*, 4> kNames{"R", "G", "B", "A"};

struct Header {
  char magic[8] = {'h', 'a', 'l', 'f', ' ', 'R', 'G', 'B'};
  std::int32_t width = 0, height = 0;

  std::size_t planes() const { return magic[4] == ' ' ? 3 : 4; }
};

Header header_of(const Image& image) {
  Header header;
  header.width = image.width;
  header.height = image.height;
  if (image.find("A") != nullptr) std::memcpy(header.magic, "halfRGBA", sizeof header.magic);
  return header;
}

bool is_known(const Header& header) {
  const Header opaque;
  return std::memcmp(header.magic, opaque.magic, sizeof header.magic) == 0 ||
         std::memcmp(header.magic, "halfRGBA", sizeof header.magic) == 0;
}

std::size_t plane_size(const Header& header) {
  return static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
}

}  // namespace

std::vector<std::uint8_t> encode_half(const Image& image) {
  const Header header = header_of(image);
  std::vector<std::uint8_t> bytes(sizeof header + header.planes() * plane_size(header) * sizeof(Imath::half));
  std::memcpy(bytes.data(), &header, sizeof header);
  std::uint8_t* at = bytes.data() + sizeof header;
  for (std::size_t k = 0; k < header.planes(); ++k) {
    const Channel* channel = image.find(kNames[k]);
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
  if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  if (bytes.size() < sizeof header || !is_known(header) || header.width <= 0 || header.height <= 0 ||
      bytes.size() != sizeof header + header.planes() * plane_size(header) * sizeof(std::uint16_t))
    throw work_error("a stored scene-linear picture has another format");
  Image image{header.width, header.height, {}};
  const std::uint8_t* at = bytes.data() + sizeof header;
  for (std::size_t k = 0; k < header.planes(); ++k) {
    Channel& channel = image.channels.emplace_back(Channel{kNames[k], {}});
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
