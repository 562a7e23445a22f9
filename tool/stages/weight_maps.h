/// The painted weights that a body's pins, pulls and regions name.
#pragma once

#include <string>
#include <vector>

#include "core/constraints/selection.h"
#include "core/mesh/surface_mesh.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Reads each of them once. Throws input_error with the field's place for a file that is no weight map, for one with
/// another count than the mesh has vertices, and for colours or attributes that the mesh does not have.
std::vector<WeightMap> read_weight_maps(const BodySettings& body, const SurfaceMesh& file_mesh);

/// Files that the constraints of a body read, resolved paths: weights and what is followed.
std::vector<std::string*> constraint_files(BodySettings& body);

}  // namespace softreel
