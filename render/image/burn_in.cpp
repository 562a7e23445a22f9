#include "render/image/burn_in.h"

#include <algorithm>

#include "render/image/text.h"

namespace softreel {

void burn_in(DisplayImage& image, const BurnIn& words) {
  TextStyle style;
  style.height = std::max(7.0f, static_cast<float>(image.height) / 36);
  style.color = Vec3f::Constant(0.96f);
  style.halo = std::max(1.5f, style.height / 6);
  style.opacity = 0.92f;
  const float margin = style.height;
  const float y = static_cast<float>(image.height) - margin - style.height;
  const float right = static_cast<float>(image.width) - margin - text_width(words.right, style.height);
  draw_text(image, right, y, words.right, style);
  draw_text(image, margin, y, shortened_text(words.left, style.height, right - 2 * margin), style);
}

}  // namespace softreel
