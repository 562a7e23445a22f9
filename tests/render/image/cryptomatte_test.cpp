#include "render/image/cryptomatte.h"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

namespace softreel {
namespace {

TEST(Cryptomatte, HashesAreMurmurs) {
  // Published values of MurmurHash3_x86_32 with seed 0.
  EXPECT_EQ(murmur_hash3(""), 0u);
  EXPECT_EQ(murmur_hash3("hello"), 0x248bfa47u);
  EXPECT_EQ(murmur_hash3("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(murmur_hash3("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

TEST(Cryptomatte, EveryIdIsANormalNumber) {
  for (int k = 0; k < 5000; ++k) {
    const float id = std::bit_cast<float>(cryptomatte_id("body" + std::to_string(k)));
    EXPECT_TRUE(std::isnormal(id)) << k;
  }
  EXPECT_EQ(cryptomatte_id(""), 1u << 23) << "a hash of 0 gets the lowest exponent";
}

TEST(Cryptomatte, MetadataNamesLayerHashAndIds) {
  Image image{2, 1, {}};
  EXPECT_EQ(add_cryptomatte(image, {"CryptoObject", {"hello", "say \"x\"", "hello"}}), 0u);
  EXPECT_EQ(image.channels.size(), std::size_t{2 * kCryptomatteRanks});
  EXPECT_EQ(image.channels[0].name, "CryptoObject00.R");
  EXPECT_EQ(image.channels[3].name, "CryptoObject00.A");
  EXPECT_EQ(image.channels[4].name, "CryptoObject01.R");
  ASSERT_EQ(image.attributes.size(), 4u);
  std::string manifest;
  for (const auto& [key, value] : image.attributes) {
    EXPECT_TRUE(key.starts_with("cryptomatte/")) << key;
    EXPECT_EQ(key.find('/', 12), 19u) << "seven digits: " << key;
    if (key.ends_with("/manifest")) manifest = value;
  }
  EXPECT_NE(manifest.find("\"hello\":\"248bfa47\""), std::string::npos) << manifest;
  EXPECT_NE(manifest.find("\"say \\\"x\\\"\":"), std::string::npos) << manifest;
}

TEST(Cryptomatte, RanksFallAndTheLeastAreLeftOut) {
  Image image{2, 1, {}};
  const std::size_t first = add_cryptomatte(image, {"L", {}});
  std::vector<IdCoverage> ids;
  for (int k = 1; k <= 8; ++k) ids.push_back({static_cast<float>(k), 0.01f * static_cast<float>(k)});
  store_cryptomatte(image, first, 1, ids);
  for (std::size_t rank = 0; rank < kCryptomatteRanks; ++rank) {
    EXPECT_EQ(image.channels[2 * rank].pixels[1], static_cast<float>(8 - rank));
    EXPECT_EQ(image.channels[2 * rank].pixels[0], 0);
    EXPECT_FLOAT_EQ(image.channels[2 * rank + 1].pixels[1], 0.01f * static_cast<float>(8 - rank));
  }
}

}  // namespace
}  // namespace softreel
