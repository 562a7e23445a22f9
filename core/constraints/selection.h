/// Which surface points a pin, pull or region takes.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/base/types.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Unit of the numbers of a selection: metres in the scene, or the box of the placed body, 0 to 1 along each axis.
enum class SelectionUnit { Meter, Box };

struct SelectBox {
  Vec3 min, max;
};
struct SelectSphere {
  Vec3 center;
  double radius = 0;  ///< with SelectionUnit::Box: in heights of the box
};
/// The side that the normal points to.
struct SelectPlane {
  Vec3 point, normal;
};
struct SelectGroup {
  std::string name;
};
struct SelectNearest {
  Vec3 point;
  Index count = 1;
};
struct SelectAll {};

struct SelectionTerm {
  std::variant<SelectBox, SelectSphere, SelectPlane, SelectGroup, SelectNearest, SelectAll> shape;
  SelectionUnit unit = SelectionUnit::Meter;
};

/// The union of its terms.
struct Selection {
  std::vector<SelectionTerm> terms;
};

/// Vertices of the placed surface that the selection takes, sorted; only vertices that triangles use. Empty if it takes
/// none: the caller says so, with the field's place. Throws input_error for an unknown group, naming the nearest one.
std::vector<Index> select_points(const Selection& selection, const SurfaceMesh& surface);

/// True for each of `points` (element centroids, say) that lies in the selection. Groups and nearest select points of
/// the surface only: a point is taken if its nearest used surface vertex is.
std::vector<bool> contains(const Selection& selection, const SurfaceMesh& surface, const std::vector<Vec3>& points);

}  // namespace softreel
