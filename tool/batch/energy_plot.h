/// Energies over the frames as a small drawing in SVG.
#pragma once

#include <string>
#include <vector>

#include "tool/report/energy_history.h"

namespace softreel {

/// Kinetic, elastic, gravity's and total energy of all bodies together, at the frames where all are known. An <svg>
/// element for HTML, with classes in place of colours (plot-kinetic, plot-elastic, plot-gravity, plot-total: lines;
/// plot-axis, plot-text) and a title for those who do not see it. Empty if fewer than two frames are known.
std::string energy_plot(const std::vector<BodyEnergies>& energies);

/// Steps of 1, 2 or 5 times a power of ten that cover [low, high] in at most `most` of them; high must be above low.
std::vector<double> round_steps(double low, double high, int most);

}  // namespace softreel
