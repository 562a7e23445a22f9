/// The painted weights that a body's pins, pulls, regions and glue name.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/constraints/selection.h"
#include "core/mesh/surface_mesh.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Reads each of them once. Throws input_error with the field's place for a file that is no weight map, for one with
/// another count than the mesh has vertices, and for colours or attributes that the mesh does not have.
/// glues: of the shot; those of whose bodies this is the first take its points.
std::vector<WeightMap> read_weight_maps(const BodySettings& body, std::span<const GlueSettings> glues,
                                        const SurfaceMesh& file_mesh);

/// Files that the constraints of a body read, resolved paths: weights and what is followed. glues: of the shot.
std::vector<std::string*> constraint_files(BodySettings& body, std::span<GlueSettings> glues);

}  // namespace softreel
