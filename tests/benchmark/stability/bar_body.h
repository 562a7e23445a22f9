/// A bar that stands for a limb: held at one end, moved at the other (the paper's figures 4 and 5).
#pragma once

#include <array>

#include "core/dynamics/simulator.h"

namespace softreel::bench {

/// How a bar is shaped and what it is made of.
struct BarBody {
  std::array<int, 3> cells{8, 4, 4};  ///< along x, y, z, each cut in six tetrahedra
  double cell_length = 0.1;           ///< along x, m; 0.1 m the other ways
  ElementMaterial material{1e5, 0.3, 1000, 2, 0.01};
};

/// Pinned at both ends; the pin at the high end has the keys of `far_end`. No gravity.
BodyModel make_bar_model(const BarBody& bar, const Track<Transform>& far_end);

/// Pinned at the low end only.
BodyModel make_cantilever_model(const BarBody& bar);

/// Length and middle of the cross section, m.
double length_of(const BarBody& bar);
Vec3 axis_of(const BarBody& bar);

}  // namespace softreel::bench
