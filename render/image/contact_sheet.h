/// Many small pictures on one, with a line under each.
#pragma once

#include <cstddef>
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

/// Width in pixels that a sheet of so many pictures has for each.
int sheet_cell_width(std::size_t pictures, const SheetStyle& style);

/// Row by row in the order given. Pictures already reduced to sheet_cell_width give the same sheet. At least one
/// picture; all of one size.
DisplayImage contact_sheet(const std::vector<SheetPicture>& pictures, const SheetStyle& style);

}  // namespace softreel
