/// MDD point caches: the positions of every frame in one file, as LightWave, Blender, Maya and Houdini read them.
#pragma once

#include "tool/export/exporter.h"

namespace softreel {

/// All big-endian: int32 samples, int32 points, float32 time of each sample in seconds (its frame over the rate; frame
/// 0 is at 0), then float32 x, y, z of every point of every sample.
ExportFormat mdd_format();

}  // namespace softreel
