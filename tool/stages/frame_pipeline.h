/// Frames on their way to pictures: simulated ahead, traced, and written behind, all at the same time.
#pragma once

#include <functional>

#include "tool/stages/picture_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {

struct PictureCounts {
  int kept = 0, recalled = 0, developed = 0, linked = 0, traced = 0;
  double saved_seconds = 0;  ///< what the frames that were not traced took when they were
  PictureCounts& operator+=(const PictureCounts& other);
};

/// Called when a frame's files are under way or there, from the calling thread.
using FrameDone = std::function<void(int frame, PictureSource source)>;

/// Leaves the pictures of the frames [first, last] in the output folder. With more than one thread, the next frames are
/// simulated and the last ones written while one is traced; at most a few frames are in memory at any time. Frames that
/// another process is tracing are left for the end, and taken from there. `use`: releases what no frame needs any more.
/// What a frame throws is thrown after the frames before it are finished.
PictureCounts make_pictures(ShotRun& run, SceneStage& scenes, PictureStage& pictures, int first, int last,
                            CacheUse& use, const FrameDone& done);

}  // namespace softreel
