/// The first stage of a body: its surface, and tetrahedra made elsewhere, read, checked, repaired and placed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/constraints/selection.h"
#include "core/mesh/placement.h"
#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/tet_mesh.h"
#include "tool/bodies/read_surface.h"
#include "tool/bodies/run_context.h"
#include "tool/cache/key.h"
#include "tool/shot/shot.h"

namespace softreel {

/// A body's surface as its file has it and as it stands in the scene.
struct LoadedBody {
  SurfaceMesh file_mesh;  ///< repaired triangles, positions in file units
  SurfaceMesh surface;    ///< the same, placed (m)
  Placement placement;
  std::optional<TetMesh> given;        ///< tetrahedra made elsewhere, placed (m)
  std::vector<WeightMap> weight_maps;  ///< that its constraints and regions name
  std::vector<std::string> facts;      ///< what check and repair found, one line each
  StageKey key;                        ///< of surface.positions and surface.triangles
  StageKey file_key;                   ///< of all that the mesh file says, before placement
  StageKey stored_key;                 ///< as of ReadSurface
  StageKey given_key;                  ///< of the given tetrahedra as their file has them; empty if there are none
};

/// Reads, checks, repairs and places the mesh of a body. Throws input_error.
LoadedBody load_body(const BodySettings& body, const RunContext& context, std::span<const GlueSettings> glues = {},
                     SurfaceUse use = SurfaceUse::LookUp);

}  // namespace softreel
