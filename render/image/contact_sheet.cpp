#include "render/image/contact_sheet.h"

#include <algorithm>

#include "core/base/check.h"
#include "render/image/reduce.h"
#include "render/image/text.h"

namespace softreel {
namespace {

constexpr int kGap = 12;      ///< pixels between pictures and at the border
constexpr int kCaption = 26;  ///< height of the line under a picture
constexpr int kTitle = 52;    ///< height of the title's line
constexpr float kBackground = 0.1f;

void place(DisplayImage& sheet, const DisplayImage& picture, int x, int y) {
  for (int row = 0; row < picture.height; ++row) {
    const auto from = picture.pixels.begin() + 3L * row * picture.width;
    std::copy(from, from + 3L * picture.width, sheet.pixels.begin() + 3L * ((y + row) * sheet.width + x));
  }
}

int sheet_columns(std::size_t pictures, const SheetStyle& style) {
  CHECK(pictures > 0U);
  CHECK(style.columns > 0);
  return std::min(style.columns, static_cast<int>(pictures));
}

}  // namespace

int sheet_cell_width(std::size_t pictures, const SheetStyle& style) {
  const int columns = sheet_columns(pictures, style);
  return std::max(1, (style.width - (columns + 1) * kGap) / columns);
}

DisplayImage contact_sheet(const std::vector<SheetPicture>& pictures, const SheetStyle& style) {
  const int columns = sheet_columns(pictures.size(), style), cell = sheet_cell_width(pictures.size(), style);
  std::vector<DisplayImage> small;
  for (const SheetPicture& one : pictures) {
    CHECK(one.picture.width == pictures.front().picture.width);
    CHECK(one.picture.height == pictures.front().picture.height);
    small.push_back(reduced(one.picture, cell));
  }
  const int wide = small.front().width, high = small.front().height;
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  const int top = style.title.empty() ? kGap : kTitle;
  DisplayImage sheet{columns * wide + (columns + 1) * kGap, top + rows * (high + kCaption) + kGap / 2, {}};
  sheet.pixels.resize(3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height));
  fill_rectangle(sheet, 0, 0, sheet.width, sheet.height, Vec3f::Constant(kBackground));
  draw_text(sheet, kGap, 0.5f * (kTitle - 18),
            shortened_text(style.title, 18, static_cast<float>(sheet.width - 2 * kGap)),
            {.height = 18, .color = Vec3f::Constant(0.92f)});
  for (std::size_t k = 0; k < small.size(); ++k) {
    const int column = static_cast<int>(k) % columns, row = static_cast<int>(k) / columns;
    const int x = kGap + column * (wide + kGap), y = top + row * (high + kCaption);
    place(sheet, small[k], x, y);
    draw_text(sheet, static_cast<float>(x), static_cast<float>(y + high + 7),
              shortened_text(pictures[k].caption, 10, static_cast<float>(wide)),
              {.height = 10, .color = Vec3f::Constant(0.7f)});
  }
  return sheet;
}

}  // namespace softreel
