/// The stages before time starts: load, tetrahedralise, embed, select; one body at a time.
#pragma once

#include <string>
#include <vector>

#include "core/dynamics/simulator.h"
#include "core/mesh/placement.h"
#include "core/mesh/surface_mesh.h"
#include "tool/shot/shot.h"
#include "tool/stages/key.h"
#include "tool/stages/run_context.h"

namespace softreel {

/// A body's surface as its file has it and as it stands in the scene.
struct LoadedBody {
  SurfaceMesh file_mesh;  ///< repaired triangles, positions in file units
  SurfaceMesh surface;    ///< the same, placed (m)
  Placement placement;
  std::vector<std::string> facts;  ///< what check and repair found, one line each
  StageKey key;                    ///< of surface.positions and surface.triangles
};

/// Reads, checks, repairs and places the mesh of a body. Throws input_error.
LoadedBody load_body(const BodySettings& body, const RunContext& context);

/// The tetrahedra of a body with its surface embedded in them.
struct FilledBody {
  TetMesh mesh;
  Embedding embedding;
  std::vector<Vec3> normals;  ///< of the surface at rest
  StageKey key;
  bool from_cache = false;
};

FilledBody fill_body(const BodySettings& body, const LoadedBody& loaded, const RunContext& context);

/// The key that fill_body would give, without filling.
StageKey filled_key(const BodySettings& body, const LoadedBody& loaded);

/// What the simulator takes: materials per element, pins and pulls on points. Throws input_error with the field's place
/// for a selection that takes nothing and for groups that do not exist.
BodyModel make_body_model(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                          const FilledBody& filled);

/// The selections of make_body_model alone, checked without tetrahedra: pins and pulls on surface points.
void resolve_constraints(const BodySettings& body, const SurfaceMesh& surface, std::vector<Pin>& pins,
                         std::vector<Pull>& pulls);

}  // namespace softreel
