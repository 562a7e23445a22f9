/// Tetrahedra as files of other tools: VTK .vtu, Gmsh .msh, Medit .mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// The bytes of a file that holds the mesh; all numbers exact (text is the shortest that reads back the same).
///
/// extension: ".vtu" (VTK unstructured grid, XML with appended raw binary), ".msh" (Gmsh 2.2 text, one volume) or
/// ".mesh" (Medit text, with the boundary triangles). Throws input_error for any other. Nodes and elements keep their
/// order.
std::vector<std::uint8_t> encode_tet_mesh(const TetMesh& mesh, const std::string& extension);

}  // namespace softreel
