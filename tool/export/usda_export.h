/// Universal Scene Description as text: the meshes, their materials and the camera of a shot, with a sample per frame.
#pragma once

#include "tool/export/exporter.h"

namespace softreel {

/// One file of the whole shot: /SHOT/BODY (Mesh), /SHOT/camera, /SHOT/Looks/BODY (UsdPreviewSurface; pictures
/// stay where they are, by paths relative to the file). Time codes are
/// frames. Points are the nearest float32 of each coordinate, in the file's order with its polygons; texture
/// coordinates per corner (primvars:st), colours of vertices where the look shows them (primvars:displayColor), groups
/// as GeomSubsets. In object space a mesh carries its placement as xformOp:transform. Lengths of the camera are in
/// tenths of a unit, as USD wants them. Names that USD does not allow are changed and kept as softreel:name.
///
/// Samples of a body go to scratch files, so that memory does not depend on how many there are.
ExportFormat usda_format();

}  // namespace softreel
