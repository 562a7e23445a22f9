/// Curves drawn by gnuplot as PNG and SVG.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softreel::bench {

/// Points of one label, joined by a line in the order given.
struct Series {
  std::string label;
  std::vector<double> x, y;
  bool ours = false;    ///< drawn strong, in softreel's colour; others are rivals
  bool points = false;  ///< not joined
};

struct Plot {
  std::string name;   ///< of the files: NAME.png, NAME.svg, NAME.gnuplot, NAME.dat
  std::string title;  ///< one sentence: what is shown of what
  std::string x_label, y_label;
  bool log_x = true, log_y = true;
  std::vector<Series> series;
};

/// Whether gnuplot can be started.
bool can_draw();

/// Writes the script, its data and the two pictures into `folder`. Points that a logarithmic axis cannot show are left
/// out; a series without points too. Throws std::runtime_error with gnuplot's own words if it fails.
void draw(const Plot& plot, const std::filesystem::path& folder);

}  // namespace softreel::bench
