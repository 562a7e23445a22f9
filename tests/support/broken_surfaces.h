/// Surfaces as they come out of modellers and scanners: each has one kind of damage, and a volume that is still known.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel::test {

struct BrokenSurface {
  std::string name;
  std::function<SurfaceMesh()> mesh;  ///< makes it: programs of tests list all names whenever they start
  double edge = 0;                    ///< to fill it with, m
  double thickness = 0;               ///< of open sheets, m

  // What must come out: a body ...
  double volume = 0;     ///< m^3
  double tolerance = 0;  ///< relative, of the volume
  Index pieces = 1;
  // ... or a refusal that says this.
  std::string refusal;

  double thin_volume = 0;  ///< m^3, if `volume` has thickened parts: the volume without that

  /// For the tests' names.
  friend std::ostream& operator<<(std::ostream& out, const BrokenSurface& surface) { return out << surface.name; }
};

/// One of each kind. Seeded: the same on every call.
std::vector<BrokenSurface> broken_surfaces();

}  // namespace softreel::test
