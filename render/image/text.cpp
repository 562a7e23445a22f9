#include "render/image/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/check.h"
#include "render/image/font_table.h"

namespace softreel {
namespace {

using detail::GlyphCells;

constexpr float kRows = 7;             ///< cells of a capital letter
constexpr float kBlankWidth = 3;       ///< cells
constexpr float kPenOfCell = 0.42f;    ///< radius of the pen over the edge of a cell
constexpr float kThinnestPen = 0.55f;  ///< pixels

/// The next character of UTF-8; a byte that is no UTF-8 counts as one unknown character.
char32_t take_character(std::string_view& text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80         ? 1
                             : first >> 5 == 0x6  ? 2
                             : first >> 4 == 0xE  ? 3
                             : first >> 3 == 0x1E ? 4
                                                  : 1;
  char32_t code = length == 1 ? first : first & (0x7Fu >> length);
  std::size_t used = 1;
  for (; used < length && used < text.size() && byte(used) >> 6 == 0x2; ++used) code = code << 6 | (byte(used) & 0x3Fu);
  text.remove_prefix(used);
  return used == length && (length > 1 || first < 0x80) ? code : U'\uFFFD';
}

const GlyphCells& cells_of(char32_t code) {
  if (code >= 32 && code < 127) return detail::kAsciiCells[code - 32];
  if (code == U'\u00B0') return detail::kDegreeCells;
  if (code == U'\u00B5' || code == U'\u03BC') return detail::kMicroCells;
  return detail::kUnknownCells;
}

struct Span {
  int first = 0, count = 0;  ///< columns
};

/// Columns that a letter takes; digits all take five, so that numbers do not jump from frame to frame.
Span columns_of(char32_t code, const GlyphCells& cells) {
  if (code >= U'0' && code <= U'9') return {0, 5};
  const auto is_used = [](std::uint8_t column) { return column != 0; };
  const auto first = std::find_if(cells.begin(), cells.end(), is_used);
  if (first == cells.end()) return {0, static_cast<int>(kBlankWidth)};
  const auto last = std::find_if(cells.rbegin(), cells.rend(), is_used).base();
  return {static_cast<int>(first - cells.begin()), static_cast<int>(last - first)};
}

struct Stroke {
  Vec2f from, to;  ///< pixels
};

bool is_set(const GlyphCells& cells, int column, int row) {
  return column >= 0 && column < 5 && row >= 0 && row < 8 && (cells[static_cast<std::size_t>(column)] >> row & 1) != 0;
}

/// Joins the centres of neighbouring cells; corner to corner only where no third cell joins them anyway.
void add_strokes(const GlyphCells& cells, int first_column, const Vec2f& corner, float cell,
                 std::vector<Stroke>& strokes) {
  const auto center = [&](int column, int row) -> Vec2f {
    return corner + cell * Vec2f(static_cast<float>(column - first_column) + 0.5f, static_cast<float>(row) + 0.5f);
  };
  for (int column = 0; column < 5; ++column)
    for (int row = 0; row < 8; ++row) {
      if (!is_set(cells, column, row)) continue;
      const bool right = is_set(cells, column + 1, row), below = is_set(cells, column, row + 1);
      const bool left = is_set(cells, column - 1, row);
      const Vec2f here = center(column, row);
      strokes.push_back({here, here});
      if (right) strokes.push_back({here, center(column + 1, row)});
      if (below) strokes.push_back({here, center(column, row + 1)});
      if (!right && !below && is_set(cells, column + 1, row + 1))
        strokes.push_back({here, center(column + 1, row + 1)});
      if (!left && !below && is_set(cells, column - 1, row + 1)) strokes.push_back({here, center(column - 1, row + 1)});
    }
}

float distance_to(const Stroke& stroke, const Vec2f& point) {
  const Vec2f along = stroke.to - stroke.from, offset = point - stroke.from;
  const float squared = along.squaredNorm();
  const float t = squared > 0 ? std::clamp(offset.dot(along) / squared, 0.0f, 1.0f) : 0.0f;
  return (offset - t * along).norm();
}

void blend(DisplayImage& image, int x, int y, const Vec3f& color, float share) {
  const std::size_t at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  if (!image.alpha.empty()) {  // over straight colours: what is behind counts by its alpha
    std::uint8_t& alpha = image.alpha[at / 3];
    const float sum = share + (1 - share) * static_cast<float>(alpha) / 255;
    if (sum > 0) share /= sum;
    alpha = static_cast<std::uint8_t>(std::lround(255 * sum));
  }
  for (int c = 0; c < 3; ++c) {
    std::uint8_t& value = image.pixels[at + static_cast<std::size_t>(c)];
    const float mixed = (1 - share) * static_cast<float>(value) + share * 255 * color[c];
    value = static_cast<std::uint8_t>(std::clamp(std::lround(mixed), 0L, 255L));
  }
}

/// All strokes of a letter at once: where they meet nothing is drawn twice.
void draw_strokes(DisplayImage& image, const std::vector<Stroke>& strokes, float pen, const TextStyle& style) {
  const float reach = pen + style.halo + 1;
  Vec2f low = strokes.front().from, high = low;
  for (const Stroke& stroke : strokes) {
    low = low.cwiseMin(stroke.from).cwiseMin(stroke.to);
    high = high.cwiseMax(stroke.from).cwiseMax(stroke.to);
  }
  const int x0 = std::max(0, static_cast<int>(std::floor(low.x() - reach)));
  const int y0 = std::max(0, static_cast<int>(std::floor(low.y() - reach)));
  const int x1 = std::min(image.width, static_cast<int>(std::ceil(high.x() + reach)));
  const int y1 = std::min(image.height, static_cast<int>(std::ceil(high.y() + reach)));
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const Vec2f point(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      float distance = reach;
      for (const Stroke& stroke : strokes) distance = std::min(distance, distance_to(stroke, point));
      if (style.halo > 0)
        blend(image, x, y, style.shade,
              style.opacity * std::clamp(2 * (pen + style.halo - distance) / style.halo, 0.0f, 1.0f));
      blend(image, x, y, style.color, style.opacity * std::clamp(pen + 0.5f - distance, 0.0f, 1.0f));
    }
}

}  // namespace

float text_width(std::string_view text, float height) {
  float cells = 0;
  while (!text.empty()) {
    const char32_t code = take_character(text);
    cells += static_cast<float>(columns_of(code, cells_of(code)).count) + 1;
  }
  return std::max(0.0f, cells - 1) * height / kRows;
}

std::string shortened_text(std::string text, float height, float width) {
  if (text_width(text, height) <= width) return text;
  while (!text.empty() && text_width(text + "...", height) > width) {
    // Whole characters of UTF-8 only.
    while (text.size() > 1 && static_cast<unsigned char>(text.back()) >> 6 == 0x2) text.pop_back();
    text.pop_back();
  }
  return text.empty() ? "" : text + "...";
}

void draw_text(DisplayImage& image, float x, float y, std::string_view text, const TextStyle& style) {
  CHECK(style.height > 0);
  const float cell = style.height / kRows;
  const float pen = std::max(kThinnestPen, kPenOfCell * cell);
  std::vector<Stroke> strokes;
  // The halos of all letters lie behind all letters: a wide one would shade its neighbour.
  for (const bool halo : {true, false}) {
    if (halo && style.halo <= 0) continue;
    TextStyle pass = style;
    if (halo) pass.color = style.shade;
    if (!halo) pass.halo = 0;
    float left = x;
    for (std::string_view rest = text; !rest.empty();) {
      const char32_t code = take_character(rest);
      const GlyphCells& cells = cells_of(code);
      const Span columns = columns_of(code, cells);
      strokes.clear();
      add_strokes(cells, columns.first, Vec2f(left, y), cell, strokes);
      if (!strokes.empty()) draw_strokes(image, strokes, pen, pass);
      left += static_cast<float>(columns.count + 1) * cell;
    }
  }
}

void fill_rectangle(DisplayImage& image, int x, int y, int width, int height, const Vec3f& color, float opacity) {
  for (int row = std::max(0, y); row < std::min(image.height, y + height); ++row)
    for (int column = std::max(0, x); column < std::min(image.width, x + width); ++column)
      blend(image, column, row, color, opacity);
}

}  // namespace softreel
