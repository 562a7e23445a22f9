/// Which points of an unknown mesh are held, and which are pulled.
#pragma once

#include "core/mesh/surface_mesh.h"
#include "tool/starter/starter_choices.h"

namespace softreel {

/// Sets body.held and body.pulled. Groups that the user named; else groups whose names tell (feet, base; head, top);
/// else the two ends of the placed body along its height if it stands, along its longest horizontal edge if not. Held
/// are at least three points that are not on a line, if the mesh has such; pulled is none that is held. Throws
/// input_error for a group that the mesh has not.
void choose_selections(const SurfaceMesh& surface, const StarterWishes& wishes, StarterBody& body);

/// True if the points do not lie on a line, to a thousandth of the body's size: holding them holds a body.
bool spans_an_area(const std::vector<Index>& points, const SurfaceMesh& surface);

}  // namespace softreel
