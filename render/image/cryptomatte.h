/// Cryptomatte: which objects a pixel shows, and how much of it each covers, in ordinary EXR channels.
///
/// J. Friedman and A. Jones, Fully Automatic ID Mattes with Support for Motion Blur and Transparency, 2015; names,
/// hashes and metadata after the Cryptomatte specification 1.2. Nuke, Blender and other compositors pick objects by
/// name in it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/image/image.h"

namespace softreel {

/// MurmurHash3_x86_32 with seed 0 (A. Appleby, public domain).
std::uint32_t murmur_hash3(std::string_view text);

/// Bits of the single that stands for a name: its hash, with an exponent bit turned where it would be no normal number.
std::uint32_t cryptomatte_id(std::string_view name);

/// One family of ids: "CryptoObject" with the names of all objects.
struct CryptomatteLayer {
  std::string name;
  std::vector<std::string> ids;  ///< names, in the order of their numbers; equal names are one object
};

/// Ids that a pixel holds at most; those with the least coverage are left out.
inline constexpr int kCryptomatteRanks = 6;

/// Appends the layer's planes ("NAME00.R" id, ".G" coverage, ".B" and ".A" the next pair, "NAME01.R" ...), all 0, and
/// its metadata. Returns the number of the first plane.
std::size_t add_cryptomatte(Image& image, const CryptomatteLayer& layer);

/// How much of a pixel an id covers.
struct IdCoverage {
  float id = 0;        ///< the single of cryptomatte_id
  float coverage = 0;  ///< 0 to 1
};

/// Sorts by coverage (equal ones by id, so that the order means nothing) and writes the first ranks.
void store_cryptomatte(Image& image, std::size_t first_plane, std::size_t pixel, std::vector<IdCoverage>& ids);

}  // namespace softreel
