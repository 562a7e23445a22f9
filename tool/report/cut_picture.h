/// A picture of tetrahedra: the boundary, and the elements that a cut lays bare.
#pragma once

#include <string>

#include "core/tetmesh/mesh_cut.h"
#include "tool/report/studio.h"

namespace softreel {

/// The plane that --cut asks for, in a mesh with this box and centre of mass.
///
/// text: "x", "y" or "z" for a plane through the centre of mass, with "-" before it to look from the other side, with
/// "=SHARE" after it for a plane at that share of the box from its lower end; or "X,Y,Z:NX,NY,NZ", a point and the
/// direction to look against, in the mesh's own coordinates. Empty: "x" or "z", across the shorter horizontal extent.
/// Throws input_error.
CutPlane cut_plane(const std::string& text, const Bounds& box, const Vec3& center);

/// Throws input_error for options that draw_cut_picture would refuse whatever the mesh is.
void check_cut_picture(const PictureOptions& options);

/// Draws what lies behind the plane and returns a line that says what is shown. Elements at the cut are tinted by their
/// smallest dihedral angle. Throws input_error if nothing lies behind the plane.
std::string draw_cut_picture(const TetMesh& mesh, const PictureOptions& options, const Threads& threads);

}  // namespace softreel
