/// Many small pictures on one, with a line under each.
#pragma once

#include <string>
#include <vector>

#include "render/image/image_io.h"

namespace softreel {

struct SheetPicture {
  DisplayImage picture;
  std::string caption;
};

struct SheetStyle {
  int columns = 4;
  int width = 1600;   ///< pixels, of the sheet; pictures smaller than their cell are not enlarged
  std::string title;  ///< above the pictures; empty: none
};

/// Row by row in the order given. At least one picture; all of one size.
DisplayImage contact_sheet(const std::vector<SheetPicture>& pictures, const SheetStyle& style);

}  // namespace softreel
