/// Strain, stress and displacement of simulated bodies as numbers on their surfaces, and the range that colours show.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/image/heat_legend.h"
#include "tool/bodies/body_stage.h"
#include "tool/shot/shot.h"

namespace softreel {

class ShotRun;

/// What heat is computed from. Borrows all.
struct HeatSource {
  const std::vector<Vec3>& rest_points;  ///< of the surface
  const FilledBody& filled;
  const std::vector<ElementMaterial>& materials;  ///< per element
  const std::vector<Vec3>& node_positions;        ///< deformed
};

/// The quantity at each point of the surface, in its SI unit. Strain and stress are constant in an element; they come
/// to the points by way of the nodes (skin_values).
std::vector<double> heat_values(HeatQuantity quantity, const HeatSource& source, const Threads& threads);

/// The same in each element, where strain and stress of linear elements are constant; of displacement the mean of the
/// nodes' distances from rest.
std::vector<double> element_heat_values(HeatQuantity quantity, const HeatSource& source, const Threads& threads);

/// What the ends of the colours mean.
struct HeatRange {
  double low = 0, high = 1;

  float place(double value) const { return static_cast<float>((value - low) / (high - low)); }
};

/// The next number of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten that is not below x; x above 0.
double round_up(double x);

/// What 99 % of the values at the vertices that triangles use stay below (the value of that rank); 0 of none. Others,
/// which files hold beside, are not seen, as are values that are no numbers.
double upper_end(std::vector<double> values, const SurfaceMesh& surface);

/// From 0 to the largest upper_end of a body at a frame of the whole shot, rounded up: it simulates all frames,
/// whichever are shown, so that a picture does not depend on which others are made. Single peaks, as at pins, where
/// stress of linear elements grows without end as they get finer, do not count. A shot in which nothing happens gets 0
/// to 1e-6 (of the quantity's unit).
HeatRange find_heat_range(ShotRun& run, HeatQuantity quantity);

/// The legend of a quantity: its name, and labels in a unit of its size.
HeatLegend heat_legend(HeatQuantity quantity, const HeatRange& range);
/// Of a picture, of width x height pixels, whose legend has no letters.
std::string small_legend_warning(const HeatRange& range, int width, int height);

}  // namespace softreel
