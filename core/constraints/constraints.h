/// Pins and pulls of one body, as the simulator takes them.
#pragma once

#include <string>
#include <vector>

#include "core/base/types.h"
#include "core/constraints/keys.h"

namespace softreel {

/// Exact positions: the selected surface points follow track.at(frame).apply(rest point) while active. It holds every
/// node of each tetrahedron that carries one of the points, so that the skinned points are exact too (design 4.4).
struct Pin {
  std::string name;           ///< as messages call it: "body.NAME.pin[2] (shots/a.toml:31)"
  std::vector<Index> points;  ///< surface vertices
  Track<Transform> track;
  std::vector<FrameRange> active;  ///< empty: always
};

/// Springs from surface points to keyed targets.
struct Pull {
  std::string name;
  std::vector<Index> points;    ///< surface vertices
  std::vector<double> weights;  ///< per point, sum 1: the share of the stiffness (falloff is resolved by the caller)
  Track<Transform> track;
  Track<double> stiffness;  ///< N/m, of all springs together
  double max_force = 0;     ///< N, of all springs together; 0: no limit
  std::vector<FrameRange> active;
};

}  // namespace softreel
