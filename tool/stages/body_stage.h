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
  StageKey file_key;               ///< of all that the mesh file says, before placement
};

/// Reads, checks, repairs and places the mesh of a body. Throws input_error.
LoadedBody load_body(const BodySettings& body, const RunContext& context);

/// Pins and pulls on points of the surface.
struct BodyConstraints {
  std::vector<Pin> pins;
  std::vector<Pull> pulls;
};

/// Selections and keys of a body's pins and pulls, in metres. Throws input_error with the field's place for a selection
/// that takes nothing and for groups that do not exist.
BodyConstraints resolve_constraints(const BodySettings& body, const SurfaceMesh& surface);

/// The tetrahedra of a body with its surface embedded in them.
struct FilledBody {
  TetMesh mesh;
  Embedding embedding;
  std::vector<Vec3> normals;  ///< of the surface at rest
  bool from_cache = false;
  double seconds = 0;  ///< what filling took, now or when it was stored
};

/// Version and inputs of fill_body.
StageKey filled_key(const BodySettings& body, const LoadedBody& loaded);

/// Fills the body, or reads it from the cache; `key` is its filled_key.
FilledBody fill_body(const BodySettings& body, const LoadedBody& loaded, const StageKey& key,
                     const RunContext& context);

/// Adds what shapes the materials of a body's elements: its own, and its regions. Throws input_error as
/// resolve_constraints, for regions.
void add_materials(KeyHasher& key, const Shot& shot, const BodySettings& body, const SurfaceMesh& surface);

/// What the simulator takes: materials per element, pins and pulls on points.
BodyModel make_body_model(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                          const FilledBody& filled, const BodyConstraints& constraints);

}  // namespace softreel
