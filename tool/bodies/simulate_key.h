/// The keys of simulated frames: a chain, so that an edit invalidates nothing before the first frame it can affect.
#pragma once

#include <vector>

#include "tool/bodies/body_stage.h"
#include "tool/cache/key.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Everything that shapes every frame: tetrahedra, materials (add_materials), the body's solver (solver_of), which
/// points the constraints hold.
StageKey simulation_base_key(const Shot& shot, const SolverParams& solver, const BodyConstraints& constraints,
                             const StageKey& filled, const StageKey& materials);

/// The previous frame's key with the *values* of the constraints at the sub-steps of this frame (under error control:
/// at every time where one may end): an edit that changes no value changes no key. `is_start`: the frame is where the
/// simulation starts, from the state that shot.start asks for.
StageKey frame_key(const Shot& shot, const BodyConstraints& constraints, const StageKey& previous, int frame,
                   bool is_start);

/// Of all that pins and pulls say at a frame: equal keys ask for the same.
StageKey constraints_key(const BodyConstraints& constraints, double frame);

/// True if a pin or pull takes points where they are, so that the state of a frame holds what was taken.
bool has_grabs(const BodyConstraints& constraints);

/// Where the simulation starts: the first frame less the preroll.
int first_simulated_frame(const Shot& shot);

/// Keys of all frames from first_simulated_frame to the last one over a base key.
std::vector<StageKey> chain_keys(const Shot& shot, const BodyConstraints& constraints, const StageKey& base);

/// Keys of all frames from first_simulated_frame to the last one, without simulating or filling anything.
std::vector<StageKey> simulation_keys(const Shot& shot, const SolverParams& solver, const BodyConstraints& constraints,
                                      const StageKey& filled, const StageKey& materials);

}  // namespace softreel
