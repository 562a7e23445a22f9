/// Selections, keys and what is followed: the pins and pulls of a body as the simulator takes them.
#pragma once

#include <string>
#include <vector>

#include "core/constraints/constraints.h"
#include "core/constraints/glue.h"
#include "tool/bodies/followed_files.h"
#include "tool/bodies/loaded_body.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Pins and pulls on points of the surface; of bodies that glue joins also that (glue_stage.h).
struct BodyConstraints {
  std::vector<Pin> pins;
  std::vector<Pull> pulls;
  std::vector<Glue> glues = {};
  FollowedFiles followed = {};  ///< what pins and pulls refer to
};

/// Selections, keys and what is followed of a body's pins and pulls, in metres. Throws input_error with the field's
/// place for a selection that takes nothing, for groups that do not exist, and as FollowedFiles::motion.
BodyConstraints resolve_constraints(const Shot& shot, const BodySettings& body, const LoadedBody& loaded,
                                    const Log& log);

/// The points of the body's surface that a selection takes. Throws input_error with the field's place for one that
/// takes none.
std::vector<Index> select_or_fail(const Selection& selection, const LoadedBody& loaded, const Origin& origin,
                                  const std::string& field);

}  // namespace softreel
