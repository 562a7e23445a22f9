/// The part of a picture that is computed.
#pragma once

namespace softreel {

/// Part of a picture, or more than it: pixels from left to right and top to bottom, ends excluded.
struct PixelWindow {
  int left = 0, top = 0, right = 0, bottom = 0;  ///< all 0: the picture itself

  int width() const { return right - left; }
  int height() const { return bottom - top; }
  friend bool operator==(const PixelWindow&, const PixelWindow&) = default;
};

}  // namespace softreel
