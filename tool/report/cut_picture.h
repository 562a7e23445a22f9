/// A picture of tetrahedra: the boundary, and the elements that a cut lays bare.
#pragma once

#include <string>

#include "core/tetmesh/mesh_cut.h"
#include "tool/report/cut_plane.h"
#include "tool/report/studio.h"

namespace softreel {

/// Throws input_error for options that draw_cut_picture would refuse whatever the mesh is.
void check_cut_picture(const PictureOptions& options);

/// Draws what lies behind the plane and returns a line that says what is shown. Elements at the cut are tinted by their
/// smallest dihedral angle. Throws input_error if nothing lies behind the plane.
std::string draw_cut_picture(const TetMesh& mesh, const PictureOptions& options, const Threads& threads);

}  // namespace softreel
