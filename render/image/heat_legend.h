/// The legend of a heat map, drawn on a picture.
#pragma once

#include <string>
#include <vector>

#include "render/image/image_io.h"

namespace softreel {

/// A unit for labels: what one of it is in SI units is 1 / factor.
struct LegendUnit {
  std::string name;
  double factor = 1;
};

struct HeatLegend {
  struct Tick {
    double place = 0;  ///< on the bar, 0 to 1
    std::string label;
  };
  std::string title;        ///< with the unit
  std::vector<Tick> ticks;  ///< rising
};

/// Ticks at round numbers of the unit: 1, 2, 2.5 or 5 times a power of ten apart, 3 to 7 of them. low < high: SI units.
HeatLegend make_heat_legend(const std::string& quantity, double low, double high, const LegendUnit& unit);

/// Whether a legend on a picture of this size has readable letters: not on less than 160 x 120 pixels.
bool has_legend_letters(int width, int height);

/// Draws the legend in the upper left corner: title, bar (heat_code) and labels, in sizes that go with the
/// picture's; without room for letters the bar alone.
void draw_heat_legend(const HeatLegend& legend, DisplayImage& image);

}  // namespace softreel
