/// Samples of pixels, taken by groups of paths.
#pragma once

#include <array>
#include <cstdint>

#include "render/pathtrace/path_group.h"
#include "render/pathtrace/pixel_channels.h"
#include "render/pathtrace/pixel_sums.h"
#include "render/pathtrace/rays/camera_rays.h"

namespace softreel {

static_assert(kBatch % kRayPacket == 0, "passes of whole batches are passes of whole packets");

/// A pixel that samples are taken of.
struct SampledPixel {
  int x = 0, y = 0;                   ///< in the whole picture, which keys the samples: a crop has the bits of it
  PixelSums* sums = nullptr;          ///< samples so far
  PixelChannels* gathered = nullptr;  ///< of the other channels; null where none gathers
  PixelSums before{};                 ///< when its last batch of samples (kBatch) began
};

class PixelSampling {
 public:
  /// hash: of what the picture shows.
  PixelSampling(const Picture& picture, const CameraRays& rays, std::uint64_t hash)
      : rays_(rays), hash_(hash), group_(picture) {}

  /// Up to so many samples of a pixel, which has all of them after finish(); not twice before that, and it has to stay
  /// where it is until then. Packets of camera rays are of one pixel and of samples 8 k to 8 k + 7, so that windows and
  /// passes of whole batches have the bits of the whole picture.
  void take(SampledPixel& pixel, int up_to);
  void finish();

 private:
  const CameraRays& rays_;
  std::uint64_t hash_;
  PathGroup group_;
  int packet_ = 0;                                   ///< number of the last one
  std::array<SampledPixel*, kGroupPaths> pixels_{};  ///< of the paths of the group
};

}  // namespace softreel
