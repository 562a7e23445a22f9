/// The stages between loading and time: tetrahedralise, embed, select; one body at a time.
#pragma once

#include <string>
#include <vector>

#include "core/dynamics/simulator.h"
#include "tool/shot/shot.h"
#include "tool/stages/key.h"
#include "tool/stages/loaded_body.h"
#include "tool/stages/run_context.h"

namespace softreel {

/// Pins and pulls on points of the surface; of bodies that glue joins also that (glue_stage.h).
struct BodyConstraints {
  std::vector<Pin> pins;
  std::vector<Pull> pulls;
  std::vector<Glue> glues = {};
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

/// The same without the cache: for meshes that nobody asks for again.
FilledBody fill_body_anew(const BodySettings& body, const LoadedBody& loaded, const RunContext& context);

/// The points of the surface that a selection takes. Throws input_error with the field's place, FIELD.select, if they
/// are none.
std::vector<Index> select_or_fail(const Selection& selection, const SurfaceMesh& surface, const Origin& origin,
                                  const std::string& field);

/// Adds what shapes the materials of a body's elements: its own, and its regions. Throws input_error as
/// resolve_constraints, for regions.
void add_materials(KeyHasher& key, const Shot& shot, const BodySettings& body, const SurfaceMesh& surface);

/// Materials per element: the body's own, and those of its regions.
std::vector<ElementMaterial> element_materials(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                                               const TetMesh& mesh);

/// What the simulator takes: materials per element, pins and pulls on points.
BodyModel make_body_model(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                          const FilledBody& filled, const BodyConstraints& constraints);

}  // namespace softreel
