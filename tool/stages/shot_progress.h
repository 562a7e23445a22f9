/// What of a shot is there and what is missing, without the reasons: cheap enough to be asked again and again.
#pragma once

#include <vector>

#include "tool/stages/picture_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {

struct ShotProgress {
  bool filled = false;                                ///< the cache has the tetrahedra of all bodies
  std::vector<int> not_simulated;                     ///< frames that the cache lacks for some body, rising
  std::vector<int> no_picture;                        ///< frames without the pictures that the shot asks for, rising
  bool movie_missing = false, sheet_missing = false;  ///< asked for by the shot, and not there
};

enum class Thoroughness {
  Claims,  ///< names and the manifest
  Content  ///< pictures are read, and damaged ones count as missing
};

/// Of the frames [first, last]; a movie is asked for of all frames of the shot only. Simulated frames are looked for
/// from `first` to the one after `last`, which pictures may need. `outputs`: as just read.
ShotProgress find_progress(ShotRun& run, Outputs& outputs, int first, int last, Thoroughness how);

}  // namespace softreel
