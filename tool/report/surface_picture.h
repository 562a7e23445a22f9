/// A picture of a surface: its polygons, and what is damaged about it in colour.
#pragma once

#include <string>

#include "tool/report/studio.h"

namespace softreel {

/// Draws `mesh` with the sides of its polygons, and what find_damage finds: rims of holes red, edges of more than two
/// faces orange, faces that face the wrong way and edges between such neighbours purple. Vertices that are not finite
/// are left out. The camera looks at the side that most of the damage is on. Returns a line that says what is shown.
///
/// repaired: `mesh` after repair_mesh. Throws input_error if no triangle can be drawn.
std::string draw_surface_picture(const SurfaceMesh& mesh, const SurfaceMesh& repaired, const PictureOptions& options,
                                 const Threads& threads);

}  // namespace softreel
