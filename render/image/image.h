/// Pixels with named channels, scene-linear.
#pragma once

#include <map>
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
  std::map<std::string, std::string> attributes = {};  ///< texts in the header of an EXR, by name
  /// Where the first pixel lies in the whole picture, and how large that is (EXR's display window): of a crop, or with
  /// overscan. 0 x 0: the image is the whole picture.
  int left = 0, top = 0;
  int full_width = 0, full_height = 0;

  /// The channel of that name, or null.
  const Channel* find(const std::string& name) const;
};

}  // namespace softreel
