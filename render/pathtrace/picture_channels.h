/// Names of what a picture can hold beside its colour.
#pragma once

#include <cstdint>

namespace softreel {

/// Each is written to the EXR under the names in PixelChannels.
enum class PictureChannel {
  Albedo,      ///< base colour of the first surface; glass, coat and sheen are not in it
  Normal,      ///< of the first surface, in the world, facing the camera
  Depth,       ///< m along the ray to the first surface
  Position,    ///< m, of the first surface in the world
  Motion,      ///< pixels from this frame to the next
  ObjectId,    ///< which bodies, with their coverage (Cryptomatte)
  MaterialId,  ///< which materials, with their coverage (Cryptomatte)
  Strain,      ///< of the first surface, as its mesh says it
  Samples      ///< paths that the pixel took
};

/// Some of the channels.
struct ChannelSet {
  std::uint32_t bits = 0;

  bool has(PictureChannel channel) const { return (bits >> static_cast<unsigned>(channel) & 1u) != 0; }
  void add(PictureChannel channel) { bits |= 1u << static_cast<unsigned>(channel); }
  friend bool operator==(const ChannelSet&, const ChannelSet&) = default;
};

}  // namespace softreel
