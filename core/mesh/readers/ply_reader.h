/// Polygon File Format (PLY), text and binary of either byte order, in the order of the file.
#pragma once

#include "core/mesh/readers/mesh_source.h"

namespace softreel::detail {

/// Reads the elements in any order and with any further properties, of which these have a meaning:
/// vertex: x, y, z; s and t, u and v or texture_u and texture_v (a texture coordinate per vertex); group_NAME (not 0:
///   the vertex is a member of the vertex group NAME; blanks in NAME are written as %20);
/// face: the list vertex_indices or vertex_index; the list texcoord (u, v per corner); group (polygons of value N
///   form the vertex group "N");
/// tristrips: the list vertex_indices, strips that end at -1.
/// Text numbers are read as double whatever type the header gives them. Throws input_error with line or byte.
SurfaceMesh read_ply(const MeshSource& source, const Log& log);

}  // namespace softreel::detail
