/// The stages between loading and time: tetrahedralise, embed, select; one body at a time.
#pragma once

#include <string>
#include <vector>

#include "core/dynamics/simulator.h"
#include "core/mesh/corner_normals.h"
#include "tool/bodies/constraint_stage.h"
#include "tool/bodies/loaded_body.h"
#include "tool/bodies/run_context.h"
#include "tool/cache/key.h"
#include "tool/shot/shot.h"

namespace softreel {

/// The tetrahedra of a body with its surface embedded in them.
struct FilledBody {
  TetMesh mesh;
  Embedding embedding;
  std::vector<Vec3> normals;  ///< of the surface at rest, smooth: points outside were embedded along them
  CornerNormals creases;      ///< of the same with its hard edges; empty where it has none
  bool from_cache = false;
  double seconds = 0;  ///< what filling took, now or when it was stored
};

/// Version and inputs of fill_body.
StageKey filled_key(const BodySettings& body, const LoadedBody& loaded);

/// Fills the body, or reads it from the cache; `key` is its filled_key.
FilledBody fill_body(const BodySettings& body, const LoadedBody& loaded, const StageKey& key,
                     const RunContext& context);

/// The same without the cache: for meshes that nobody asks for again.
FilledBody fill_body_anew(const BodySettings& body, const LoadedBody& loaded, const RunContext& context);

/// Adds what shapes the materials of a body's elements: its own, and its regions. Throws input_error for a region that
/// names a group or weights which the body does not have.
void add_materials(KeyHasher& key, const Shot& shot, const BodySettings& body, const LoadedBody& loaded);

/// Materials per element: the body's own, and those of its regions.
std::vector<ElementMaterial> element_materials(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                                               const TetMesh& mesh);

/// Throws input_error for a region of the body that takes no element of the mesh.
void require_regions(const BodySettings& body, const LoadedBody& loaded, const TetMesh& mesh);

/// What the simulator takes: materials per element, pins and pulls on points.
BodyModel make_body_model(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                          const FilledBody& filled, const BodyConstraints& constraints);

}  // namespace softreel
