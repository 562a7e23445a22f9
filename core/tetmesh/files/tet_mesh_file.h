/// Tetrahedra as files of other tools: VTK .vtu and .vtk, Gmsh .msh, Medit .mesh.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/log.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// The bytes of a file that holds the mesh; all numbers exact (text is the shortest that reads back the same).
///
/// extension: ".vtu" (VTK unstructured grid, XML with appended raw binary), ".msh" (Gmsh 2.2 text, one volume) or
/// ".mesh" (Medit text, with the boundary triangles). The fill of an embedded mesh is cell data "fill" of .vtu and
/// element data "fill" of .msh; .mesh has no place for it, which a warning of `log` says. Throws input_error for any
/// other. Nodes and elements keep their order.
std::vector<std::uint8_t> encode_tet_mesh(const TetMesh& mesh, const std::string& extension, const Log& log = {});

/// True for the extensions that decode_tet_mesh reads: those of encode_tet_mesh and ".vtk".
bool is_tet_mesh_extension(const std::string& extension);

/// Tetrahedra from the bytes of a file: Medit text, Gmsh 2 or 4.1 (text, binary), VTK .vtu (text, base64, appended;
/// uncompressed) or legacy .vtk (text, binary).
///
/// name: of the file, for messages. Points, lines and faces are skipped; data "fill" of the elements of .vtu and .msh
/// are TetMesh::fill. Inverted elements are turned round and nodes that no element uses are left out, each said in one
/// line of `log`. The mesh has no lattice.
/// Throws input_error, one clear message, for what is broken: an index out of range, a position that is not finite, an
/// element without volume, elements of other shapes or orders, a file that ends early or has no tetrahedra.
TetMesh decode_tet_mesh(const std::string& name, std::string_view bytes, const std::string& extension, const Log& log);

/// True if a file holds tetrahedra by its extension, in letters of either size, and is not a surface that shares it:
/// Ogre's binary .mesh.
bool is_tet_mesh_file(const std::string& path);

/// decode_tet_mesh of a file. Throws input_error for one that is missing or cannot be read, too.
TetMesh read_tet_mesh(const std::string& path, const Log& log);

}  // namespace softreel
