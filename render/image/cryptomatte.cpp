#include "render/image/cryptomatte.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <set>

#include <fmt/format.h>

namespace softreel {
namespace {

/// A name as a string of JSON.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') text += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      text += c;
  }
  return text + "\"";
}

/// {"name":"hash in 8 digits",...}
std::string manifest(const CryptomatteLayer& layer) {
  std::string text;
  for (const std::string& name : std::set<std::string>(layer.ids.begin(), layer.ids.end()))
    text += fmt::format("{}{}:\"{:08x}\"", text.empty() ? "" : ",", quoted(name), cryptomatte_id(name));
  return "{" + text + "}";
}

}  // namespace

std::uint32_t murmur_hash3(std::string_view text) {
  constexpr std::uint32_t kFirst = 0xcc9e2d51u, kSecond = 0x1b873593u;
  const auto scrambled = [](std::uint32_t word) { return std::rotl(word * kFirst, 15) * kSecond; };
  std::uint32_t hash = 0;
  std::size_t at = 0;
  for (; at + 4 <= text.size(); at += 4) {
    std::uint32_t word = 0;
    std::memcpy(&word, text.data() + at, 4);
    hash = std::rotl(hash ^ scrambled(word), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t tail = 0;
  std::memcpy(&tail, text.data() + at, text.size() - at);
  if (at < text.size()) hash ^= scrambled(tail);
  hash ^= static_cast<std::uint32_t>(text.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

std::uint32_t cryptomatte_id(std::string_view name) {
  std::uint32_t hash = murmur_hash3(name);
  const std::uint32_t exponent = hash >> 23 & 255u;
  if (exponent == 0 || exponent == 255) hash ^= 1u << 23;
  return hash;
}

std::size_t add_cryptomatte(Image& image, const CryptomatteLayer& layer) {
  const std::string key = "cryptomatte/" + fmt::format("{:08x}", cryptomatte_id(layer.name)).substr(0, 7) + "/";
  image.attributes[key + "name"] = layer.name;
  image.attributes[key + "hash"] = "MurmurHash3_32";
  image.attributes[key + "conversion"] = "uint32_to_float32";
  image.attributes[key + "manifest"] = manifest(layer);
  const std::size_t first = image.channels.size();
  const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  for (int rank = 0; rank < kCryptomatteRanks; ++rank)
    for (const char* part : rank % 2 == 0 ? std::array{"R", "G"} : std::array{"B", "A"})
      image.channels.push_back({fmt::format("{}{:02}.{}", layer.name, rank / 2, part), std::vector<float>(pixels)});
  return first;
}

void store_cryptomatte(Image& image, std::size_t first_plane, std::size_t pixel, std::vector<IdCoverage>& ids) {
  std::sort(ids.begin(), ids.end(), [](const IdCoverage& a, const IdCoverage& b) {
    return a.coverage != b.coverage ? a.coverage > b.coverage
                                    : std::bit_cast<std::uint32_t>(a.id) < std::bit_cast<std::uint32_t>(b.id);
  });
  const std::size_t ranks = std::min(ids.size(), std::size_t{kCryptomatteRanks});
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    image.channels[first_plane + 2 * rank].pixels[pixel] = ids[rank].id;
    image.channels[first_plane + 2 * rank + 1].pixels[pixel] = ids[rank].coverage;
  }
}

}  // namespace softreel
