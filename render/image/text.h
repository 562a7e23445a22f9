/// Text in pictures: a small built-in font for burn-ins, captions and legends.
///
/// Letters are dot matrices of 5 x 7 cells (two more rows below the line) whose neighbouring cells are joined by
/// strokes of a round pen, so that they are smooth at every size.
#pragma once

#include <string>
#include <string_view>

#include "core/base/types.h"
#include "render/image/image_io.h"

namespace softreel {

struct TextStyle {
  float height = 14;            ///< pixels, of a capital letter; below 7 strokes run together
  Vec3f color = Vec3f::Ones();  ///< display values, 0 to 1
  float opacity = 1;            ///< 0 to 1
  float halo = 0;  ///< pixels of shade round each stroke (dense in the inner half), for text on any picture
  Vec3f shade = Vec3f::Zero();  ///< display values of the halo
};

/// Pixels from the left edge of the first letter to the right edge of the last.
/// text: UTF-8; has ASCII, degree and micro signs; other characters are drawn as an empty box.
float text_width(std::string_view text, float height);

/// The text, or as much of its beginning as is no wider than `width` pixels, with dots; empty if that is nothing.
std::string shortened_text(std::string text, float height, float width);

/// Draws one line. x, y: pixels, top left corner of its capitals, row 0 on top; what leaves the picture is cut off.
void draw_text(DisplayImage& image, float x, float y, std::string_view text, const TextStyle& style);

/// Fills the rectangle's part that is in the picture. x, y, width, height: pixels; color: display values.
void fill_rectangle(DisplayImage& image, int x, int y, int width, int height, const Vec3f& color, float opacity = 1);

}  // namespace softreel
