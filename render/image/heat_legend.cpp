#include "render/image/heat_legend.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/check.h"
#include "render/image/text.h"
#include "render/scene/color_map.h"

namespace softreel {

namespace {

constexpr float kReadable = 120;  ///< pixels, least height of a picture with letters
const Vec3f kPanel(0.07f, 0.075f, 0.08f), kInk(0.96f, 0.96f, 0.94f);
constexpr float kPanelOpacity = 0.72f;

/// Distance between ticks.
double tick_step(double extent) {
  const double power = std::pow(10.0, std::floor(std::log10(extent / 3)));
  for (const double step : {1.0, 2.0, 2.5, 5.0, 10.0})
    if (extent / (step * power) < 6.5) return step * power;
  return 20 * power;
}

/// Digits after the point that a multiple of `step` needs.
int digits_of(double step) {
  int digits = 0;
  for (double scaled = step; digits < 9 && std::abs(scaled - std::round(scaled)) > 1e-6 * scaled; scaled *= 10)
    ++digits;
  return digits;
}

/// Pixels. The panel lies in the upper left corner: bodies are framed in the middle, and stand on the ground.
struct Layout {
  int bar_x = 0, bar_y = 0, bar_width = 0, bar_height = 0;
  int panel_x = 0, panel_y = 0, panel_width = 0, panel_height = 0;
  float letter = 0;  ///< height; 0: none is readable
};

/// Pixels; of a narrow picture less than it is high.
float used_height(int width, int height) {
  return std::min(static_cast<float>(height), 0.75f * static_cast<float>(width));
}

Layout lay_out(const HeatLegend& legend, const DisplayImage& image) {
  Layout l;
  const float height = used_height(image.width, image.height);
  l.letter = height >= kReadable ? std::max(8.0f, std::round(height / 50)) : 0.0f;
  const float unit = l.letter > 0 ? l.letter : std::max(1.0f, height / 30);
  const auto pixels = [unit](float letters) { return static_cast<int>(std::lround(letters * unit)); };
  l.bar_width = static_cast<int>(0.3f * static_cast<float>(image.width));
  if (l.letter > 0)
    l.bar_width = std::max(l.bar_width, static_cast<int>(std::ceil(text_width(legend.title, l.letter))));
  l.bar_height = pixels(1.1f);
  const int title = l.letter > 0 ? pixels(1.7f) : 0, labels = l.letter > 0 ? pixels(1.7f) : 0;
  // Labels stand out over the bar's ends by half their width.
  const int side = pixels(1.8f);
  l.panel_width = l.bar_width + 2 * side;
  l.panel_height = pixels(0.8f) + title + l.bar_height + labels + pixels(0.8f);
  l.panel_x = pixels(1);
  l.panel_y = pixels(1);
  l.bar_x = l.panel_x + side;
  l.bar_y = l.panel_y + pixels(0.8f) + title;
  return l;
}

void draw_bar(const Layout& l, DisplayImage& image) {
  for (int column = 0; column < l.bar_width; ++column)
    fill_rectangle(image, l.bar_x + column, l.bar_y, 1, l.bar_height,
                   heat_code((static_cast<float>(column) + 0.5f) / static_cast<float>(l.bar_width)));
}

void draw_letters(const HeatLegend& legend, const Layout& l, DisplayImage& image) {
  TextStyle style;
  style.height = l.letter;
  style.color = kInk;
  draw_text(image, static_cast<float>(l.bar_x), static_cast<float>(l.panel_y) + 0.8f * l.letter, legend.title, style);
  const int stroke = std::max(1, static_cast<int>(l.letter / 9)), end = l.bar_y + l.bar_height;
  float free = -1e9f;  // from here on no label stands yet
  for (const HeatLegend::Tick& tick : legend.ticks) {
    const float x = static_cast<float>(l.bar_x) + static_cast<float>(tick.place) * static_cast<float>(l.bar_width);
    const int left = std::clamp(static_cast<int>(std::lround(x)) - stroke / 2, l.bar_x, l.bar_x + l.bar_width - stroke);
    fill_rectangle(image, left, end, stroke, static_cast<int>(0.4f * l.letter), kInk);
    const float width = text_width(tick.label, l.letter), label = x - 0.5f * width;
    if (label < free) continue;
    draw_text(image, label, static_cast<float>(end) + 0.75f * l.letter, tick.label, style);
    free = label + width + 0.5f * l.letter;
  }
}

}  // namespace

HeatLegend make_heat_legend(const std::string& quantity, double low, double high, const LegendUnit& unit) {
  CHECK(low < high);
  HeatLegend legend;
  legend.title = fmt::format("{}, {}", quantity, unit.name);
  const double from = low * unit.factor, to = high * unit.factor;
  const double step = tick_step(to - from), tolerance = 1e-6 * (to - from);
  const int digits = digits_of(step);
  for (double k = std::ceil((from - tolerance) / step); k * step <= to + tolerance; ++k) {
    const double value = k == 0 ? 0.0 : k * step;
    legend.ticks.push_back({std::clamp((value - from) / (to - from), 0.0, 1.0), fmt::format("{:.{}f}", value, digits)});
  }
  return legend;
}

bool has_legend_letters(int width, int height) {
  return used_height(width, height) >= kReadable;
}

void draw_heat_legend(const HeatLegend& legend, DisplayImage& image) {
  const Layout l = lay_out(legend, image);
  fill_rectangle(image, l.panel_x, l.panel_y, l.panel_width, l.panel_height, kPanel, kPanelOpacity);
  draw_bar(l, image);
  if (l.letter > 0) draw_letters(legend, l, image);
}

}  // namespace softreel
