/// Pixels with named channels, scene-linear.
#pragma once

#include <string>
#include <vector>

#include "core/base/types.h"

namespace softreel {

/// One named plane of pixels: height x width, row 0 on top.
struct Channel {
  std::string name;  ///< as in EXR: "R", "albedo.G", "normal.X", "depth.Z"
  std::vector<float> pixels;
};

struct Image {
  int width = 0, height = 0;
  std::vector<Channel> channels;

  /// The channel of that name, or null.
  const Channel* find(const std::string& name) const;
};

}  // namespace softreel
