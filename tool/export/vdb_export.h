/// OpenVDB level sets of the deformed surface, one file a sample.
#pragma once

#include "tool/export/exporter.h"

namespace softreel {

/// The format: a float grid `surface` of signed distances near the surface, in the space and unit asked for, on voxels
/// of ExportSettings::voxel; where that is 0, of 1/kVoxelsAcross of the diagonal of the body's box at rest.
/// Throws input_error for a surface that is not closed, for more voxels than kMostVoxels, and where softreel was built
/// without OpenVDB.
ExportFormat vdb_format();
inline constexpr double kVoxelsAcross = 160;
inline constexpr double kMostVoxels = 5e8;  ///< near the surface; about 4 GB while they are made

}  // namespace softreel
