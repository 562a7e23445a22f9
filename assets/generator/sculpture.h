/// What a sculpture is: a solid as a signed distance, and the names of its parts.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "core/mesh/surface_mesh.h"

namespace softreel::sculpt {

/// Names the vertices where `contains` is true.
struct Part {
  std::string name;
  std::function<bool(const Vec3&)> contains;
};

/// Where the lattice is finer: it shrinks towards `center` by `strength` at most, and not at all beyond `radius`.
struct Lens {
  Vec3 center = Vec3::Zero();
  double radius = 1;    ///< m
  double strength = 0;  ///< in [0, 0.9]: the cells at the centre are 1 - strength as large
};

struct Sculpture {
  std::string name;                             ///< of the file, without ending
  std::function<double(const Vec3&)> distance;  ///< m, negative inside
  Bounds bounds;                                ///< holds the solid with a few cells to spare
  double cell = 0.01;                           ///< m, edge of the sampling lattice
  std::vector<Lens> lenses;                     ///< applied one after the other
  std::vector<Part> parts;
  std::function<Vec3(const Vec3&)> color;  ///< of the surface at a point, sRGB code values in [0, 1]; empty: none
  /// Texture coordinates of a corner of a triangle with that normal; empty: none.
  std::function<Vec2(const Vec3&, const Vec3&)> texture_coordinate;
};

/// A baby dragon on two big feet, one arm up in greeting: head, neck and tail to pull, ears and arms that follow.
Sculpture make_creature();

/// A foal on slender legs, for the shot with stiff legs and soft knees.
Sculpture make_colt();

/// A quilted bar, 1 x 0.25 x 0.25 m along x, whose seams show how it bends and twists.
Sculpture make_bar();

/// A plump octopus on eight curled arms.
Sculpture make_octopus();

/// A fluted pudding of three tiers, turned out of its mould.
Sculpture make_pudding();

}  // namespace softreel::sculpt
