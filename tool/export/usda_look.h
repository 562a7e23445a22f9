/// A material as prims of the text form of USD: UsdPreviewSurface and the textures that it shows.
#pragma once

#include <string>

#include "tool/export/exporter.h"

namespace softreel {

/// Where a layer in a folder finds a file: relative to it, as text, which is how it is joined to the layer's path, or
/// whole where that leads elsewhere, for the folder lies behind a link. Between its signs, @.
std::string usda_asset(const std::string& path, const std::string& folder);

/// parent: path of the prim that holds the material, `name` its name there; folder: of the layer, from which the paths
/// of pictures are told. Glass is opacity with its index; the strength of reflections is an index as well, as
/// UsdPreviewSurface has no other word for it beside metals. Textures are left out where the mesh has no coordinates.
/// Colours of vertices are read from primvars:displayColor of the mesh.
std::string usda_look(const ExportBody& body, const std::string& name, const std::string& parent,
                      const std::string& folder);

}  // namespace softreel
