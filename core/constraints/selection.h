/// Which surface points a pin, pull or region takes.
#pragma once

#include <span>
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

/// Which painted weights are meant: a number per vertex, from one of these.
struct WeightSource {
  std::string file;       ///< one number a line, or a PLY file; resolved path
  std::string attribute;  ///< a property of the vertices of that PLY file, without one of the mesh file itself
  std::string color;      ///< a channel of the vertex colours of the mesh file: "red", "green" or "blue"
  bool operator==(const WeightSource&) const = default;
};
/// Vertices whose weight is at least the threshold.
struct SelectWeights {
  WeightSource source;
  double threshold = 0.5;
};

/// Painted weights of a surface.
struct WeightMap {
  WeightSource source;
  std::vector<double> weights;  ///< per vertex, 0 to 1
};

struct SelectionTerm {
  std::variant<SelectBox, SelectSphere, SelectPlane, SelectGroup, SelectNearest, SelectAll, SelectWeights> shape;
  SelectionUnit unit = SelectionUnit::Meter;
};

/// The union of its terms.
struct Selection {
  std::vector<SelectionTerm> terms;
};

/// Vertices of the placed surface that the selection takes, sorted; only vertices that triangles use. Empty if it takes
/// none: the caller says so, with the field's place. maps: the painted weights that the selection names. Throws
/// input_error for an unknown group, naming the nearest one.
std::vector<Index> select_points(const Selection& selection, const SurfaceMesh& surface,
                                 std::span<const WeightMap> maps = {});

/// The weights of a source, which must be among the maps.
const std::vector<double>& weights_of(const WeightSource& source, std::span<const WeightMap> maps);

/// True for each of `points` (element centroids, say) that lies in the selection. Groups, nearest and weights select
/// points of the surface only: a point is taken if its nearest used surface vertex is.
std::vector<bool> contains(const Selection& selection, const SurfaceMesh& surface, const std::vector<Vec3>& points,
                           std::span<const WeightMap> maps = {});

}  // namespace softreel
