/// The stage of the error dial: what of a body's mesh, steps and tolerance the shot leaves to solver.error, chosen by
/// short runs of the shot on coarse meshes (core/dynamics/error_dial.h).
#pragma once

#include <optional>
#include <string>

#include "core/dynamics/error_dial.h"
#include "tool/bodies/body_stage.h"
#include "tool/bodies/run_context.h"
#include "tool/cache/key.h"
#include "tool/shot/shot.h"

namespace softreel {

/// What the dial chose for one body, and what it believes of it.
struct BodyDial {
  double asked = 0;  ///< over the diagonal of the body's box
  DialChoice choice;
  double seconds = 0;  ///< what the pilots took, now or when the result was stored
  bool from_cache = false;
};

/// What is asked for a body; what the shot gives itself is not for the dial to choose. A body of a given size but for a
/// number is filled to know it.
DialRequest dial_request(Shot shot, const BodySettings& body, const LoadedBody& loaded, const RunContext& context);

/// Everything the choice depends on. Where dial is off: empty.
StageKey dial_key(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                  const BodyConstraints& constraints);

/// The stored choice, if there is one.
std::optional<BodyDial> stored_dial(const Shot& shot, const StageKey& key, const RunContext& context);

/// Chooses, or reads the stored choice. Pilots run over all frames of a dynamic shot and over at most 8 of a static
/// one; at most 2000 vertices, evenly taken, are compared. Throws input_error where no pilot can be run, and where
/// nothing is given and max_tets and max_substeps do not suffice; else warns.
BodyDial turn_body_dial(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                        const BodyConstraints& constraints, const StageKey& key, const RunContext& context);

/// The shot with what it leaves open for `body` (an index) filled in: as chosen, or by defaults where nothing was
/// chosen yet.
Shot filled_in(Shot shot, std::size_t body, const std::optional<BodyDial>& dial);

/// "error 0.43 % believed, 0.5 % asked (mesh 0.34, time 0.09, solver 0.002): 41000 tetrahedra, 6 steps a frame, ..."
std::string describe(const BodyDial& dial, const Shot& shot);

}  // namespace softreel
