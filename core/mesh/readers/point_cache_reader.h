/// Point caches of other programs: PC2 (3ds Max, Blender) and MDD (LightWave, Blender, Houdini).
#pragma once

#include <string>

#include "core/mesh/point_cache.h"

namespace softreel {

/// True if the name ends in .pc2 or .mdd.
bool is_point_cache_file(const std::string& path);

/// The samples of a file. The first one is at 0 s; those of PC2 follow each other by the file's sample rate in frames
/// of `fps` a second, those of MDD at its own times. Throws input_error for a file that is missing, cut off, empty or
/// no such cache, and for times that do not rise and positions that are not finite.
PointCache read_point_cache(const std::string& path, double fps);

}  // namespace softreel
