/// The keys of simulated frames: a chain, so that an edit invalidates nothing before the first frame it can affect.
#pragma once

#include "core/dynamics/simulator.h"
#include "tool/shot/shot.h"
#include "tool/stages/key.h"

namespace softreel {

/// Everything that shapes every frame: tetrahedra, material, solver, which points the constraints hold.
StageKey simulation_base_key(const Shot& shot, const BodyModel& model, const StageKey& filled_key);

/// The previous frame's key with the *values* of the constraints at the sub-steps of this frame: an edit that changes
/// no value changes no key. `is_start`: the frame is where the simulation starts, from the state that shot.start asks
/// for.
StageKey frame_key(const Shot& shot, const BodyModel& model, const StageKey& previous, int frame, bool is_start);

}  // namespace softreel
