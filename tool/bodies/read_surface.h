/// A mesh file's surface as it is after reading, checking and repairing, kept in the cache where that takes long.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/surface_mesh.h"
#include "tool/bodies/run_context.h"
#include "tool/cache/key.h"

namespace softreel {

/// What becomes of a surface that is not in the cache.
enum class SurfaceUse {
  Keep,   ///< it is stored
  LookUp  ///< nothing is stored, for commands that only look
};

struct ReadSurface {
  SurfaceMesh mesh;                ///< repaired triangles, positions in file units
  std::vector<std::string> facts;  ///< what check and repair found, one line each
  StageKey key;                    ///< of all that the file says
  StageKey stored;                 ///< under which the cache keeps such surfaces; empty: it keeps none of such files
};

/// Only files that say everything themselves, and are so large that reading them takes longer than a moment, are kept:
/// OBJ, OFF, PLY and STL of 1 MB and more. What reading said is said again. Throws input_error.
ReadSurface read_surface(const std::string& path, SurfaceUse use, const RunContext& context);

/// Of all that a mesh file says, before placement.
StageKey mesh_file_key(const SurfaceMesh& mesh);

}  // namespace softreel
