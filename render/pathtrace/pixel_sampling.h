/// Samples of pixels, taken by batches of paths.
#pragma once

#include "render/pathtrace/camera_rays.h"
#include "render/pathtrace/path_batch.h"
#include "render/pathtrace/pixel_channels.h"
#include "render/pathtrace/pixel_sums.h"

namespace softreel {

/// A pixel that samples are taken of.
struct SampledPixel {
  int x = 0, y = 0;                   ///< in the whole picture, which keys the samples: a crop has the bits of it
  PixelSums* sums = nullptr;          ///< samples so far
  PixelChannels* gathered = nullptr;  ///< of the other channels; null without
  PixelSums before{};                 ///< when its last batch (kBatch) began
};

class PixelSampling {
 public:
  /// hash: of what the picture shows.
  PixelSampling(const Picture& picture, const CameraRays& rays, std::uint64_t hash)
      : rays_(rays), hash_(hash), batch_(picture) {}

  /// Up to so many samples of a pixel, which has all of them after finish(); not twice before that.
  void take(SampledPixel& pixel, int up_to);
  void finish();

 private:
  const CameraRays& rays_;
  std::uint64_t hash_;
  PathBatch batch_;
  std::array<SampledPixel*, kBatchPaths> pixels_{};  ///< of the paths of the batch
};

}  // namespace softreel
