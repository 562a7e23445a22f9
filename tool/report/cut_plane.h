/// The plane that --cut asks for.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/surface_mesh.h"
#include "core/tetmesh/mesh_cut.h"

namespace softreel {

/// What the words for planes refer to.
struct CutSpace {
  Bounds box;                  ///< of the nodes that elements use
  Vec3 center = Vec3::Zero();  ///< of mass, of even density
};

/// Of some meshes together; at least one element.
CutSpace cut_space(const std::vector<const TetMesh*>& meshes);

/// The plane that --cut asks for, in a mesh with this box and centre of mass.
///
/// text: "x", "y" or "z" for a plane through the centre of mass, with "-" before it to look from the other side, with
/// "=SHARE" after it for a plane at that share of the box from its lower end; or "X,Y,Z:NX,NY,NZ", a point and the
/// direction to look against, in the mesh's own coordinates. Empty: "x" or "z", across the shorter horizontal extent.
/// Throws input_error.
CutPlane cut_plane(const std::string& text, const Bounds& box, const Vec3& center);

/// Throws input_error for a text that is no plane, whatever the mesh is.
void check_cut(const std::string& text);

/// "x", "-x", "y" ...: the plane that who looks from `toward` sees most face on.
std::string cut_facing(const Vec3& toward);

}  // namespace softreel
