/// From a mesh file's own axes, unit and origin to the scene, and back.
#pragma once

#include <vector>

#include "core/mesh/surface_mesh.h"

namespace softreel {

struct PlacementParams {
  enum class Up { X, Y, Z };

  Up up = Up::Y;                   ///< the file's axis that points up; turned to the scene's +Y
  double fit = 0;                  ///< m: height of the used vertices, stood on y = 0, centred in x and z; 0: as it is
  double scale = 1;                ///< m per unit of the file; where fit is 0
  Vec3 translate = Vec3::Zero();   ///< m, last of all
  Vec3 rotate_rad = Vec3::Zero();  ///< rad about the scene's x axis, then y, then z, after fit and scale
};

/// The affine map linear p + offset. `linear` is a rotation times a scale.
struct Placement {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();

  Vec3 operator()(const Vec3& p) const { return linear * p + offset; }
};

/// The map that the parameters ask for. Throws input_error if there is no height to fit, or if fit or scale is no
/// positive number; the caller prefixes the field's place.
Placement place(const SurfaceMesh& mesh, const PlacementParams& params);

/// Moves all positions.
void apply(const Placement& placement, SurfaceMesh& mesh);

/// Where a vertex goes in the file's own axes and unit: its position in the file plus what deformation moved it.
/// rest, deformed: the same vertex in the scene, m. Exactly file_position, bit for bit, where deformed == rest.
Vec3 undo(const Placement& placement, const Vec3& file_position, const Vec3& rest, const Vec3& deformed);

}  // namespace softreel
