/// Words at the lower edge of a picture: which shot and which frame it is.
#pragma once

#include <string>

#include "render/image/image_io.h"

namespace softreel {

struct BurnIn {
  std::string left, right;
};

/// Draws the words over the picture, legible on any; their size follows the picture's. A left text that would meet the
/// right one is cut off with dots.
void burn_in(DisplayImage& image, const BurnIn& words);

}  // namespace softreel
