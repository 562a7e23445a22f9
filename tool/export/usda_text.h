/// Pieces of the text form of Universal Scene Description, as Pixar's usdcat writes them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/mesh/placement.h"
#include "core/mesh/surface_mesh.h"

namespace softreel {

/// Names of prims, different from each other: letters, digits and '_', not starting with a digit.
class UsdaNames {
 public:
  std::string unique(const std::string& name);

 private:
  std::vector<std::string> taken_;
};

/// In double quotes, with escapes.
std::string usda_quoted(const std::string& text);

/// "[(x, y, z), ...]"; each number is the shortest decimal that reads back as the same float32.
std::string usda_vectors(std::span<const float> values, std::size_t components);
std::string usda_integers(std::span<const Index> values);

/// "( (a, b, c, 0), ... )": USD multiplies rows from the left, so that the offset is the last row.
std::string usda_matrix(const Placement& placement);

/// What does not change of a mesh: polygons, texture coordinates, and its groups as subsets of faces, or of points
/// where no polygon names them. Lines start with `indent`.
std::string usda_topology(const SurfaceMesh& mesh, const std::string& indent);
/// The groups, which come behind all attributes.
std::string usda_groups(const SurfaceMesh& mesh, const std::string& indent);

}  // namespace softreel
