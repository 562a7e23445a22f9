/// What making the missing frames of a shot should take.
#pragma once

#include "tool/commands/session.h"
#include "tool/stages/picture_stage.h"
#include "tool/stages/scene_stage.h"
#include "tool/stages/shot_run.h"

namespace softreel {

/// Within a factor of two on the machine of the plan's figures.
struct PlanEstimate {
  double bytes = 0;  ///< of memory
  double fill_seconds = 0, simulate_seconds = 0, render_seconds = 0;
  int traced = 0;  ///< pictures that render_seconds are for
};

PlanEstimate estimate_plan(const ShotRun& run, const SceneStage& scenes, const PictureStage& pictures,
                           const FrameSpan& frames, int threads);

}  // namespace softreel
