/// The metric of the golden images.
#pragma once

#include "render/image/image_io.h"

namespace softreel {

/// How far two display pictures are apart. Errors are of 8-bit values over 255.
struct ImageDifference {
  bool same_size = true;
  bool identical = true;
  double rmse = 0;               ///< over all values
  double max_error = 0;          ///< largest single value
  double block_error = 0;        ///< largest mean error of an 8 x 8 block: sees a moved edge, forgives noise
  int worst_x = 0, worst_y = 0;  ///< top left pixel of that block
};

ImageDifference compare(const DisplayImage& a, const DisplayImage& b);

}  // namespace softreel
