/// The connected parts of a surface: shells that a body may lose where the lattice is too coarse.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Triangles that are joined through vertices of equal position; open ones also where they nearly meet, so that a soup
/// of triangles is one part.
struct SurfacePart {
  Index triangles = 0;
  double volume = 0;  ///< signed, m^3: negative if inside out, or a cavity
  double area = 0;    ///< m^2
  Bounds box;
  bool open = false;  ///< has edges that are not used as often in one direction as in the other
  std::string name;   ///< for messages: "part 2 of 3 (group 'eye_L', 320 triangles)"

  /// Encloses nothing worth a tetrahedron.
  bool is_flat() const;
  /// For messages: the name and where it is, "part 2 of 3 (320 triangles) near (0, 1, 0)".
  std::string place() const;
};

struct SurfaceParts {
  std::vector<SurfacePart> parts;     ///< in the order of their first triangle
  std::vector<Index> triangle_parts;  ///< per triangle

  double area() const;
  /// Volume of all parts: cavities count negative if the whole is positive. Magnitude, m^3.
  double volume() const;
};

/// The first open part that encloses nothing: on both sides of it the surface goes about half round, as it does beside
/// a plane. -1 if there is none. A part with holes has an inside as long as they are smaller than the rest.
Index find_sheet(const SurfaceMesh& surface, const SurfaceParts& parts);

SurfaceParts find_parts(const SurfaceMesh& surface);

/// The same of shells: triangles that are connected across edges which have two of them. Cubes that share no more than
/// a corner or an edge are two. Triangles that are lines or points belong to none: -1.
SurfaceParts find_shells(const SurfaceMesh& surface);

}  // namespace softreel
