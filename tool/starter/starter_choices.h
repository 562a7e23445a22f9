/// What `softreel new` chooses for a mesh: which way is up, how large, what holds and what pulls it, how it is filled.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tool/bodies/body_stage.h"
#include "tool/bodies/run_context.h"
#include "tool/shot/shot.h"

namespace softreel {

/// What the user wants otherwise than chosen.
struct StarterWishes {
  std::string up;                       ///< "x" | "y" | "z"; empty: chosen
  std::vector<std::string> pin_groups;  ///< groups of the mesh that are held; empty: chosen
  std::vector<std::string> pull_groups;
  std::int64_t tets = 0;  ///< 0: chosen
};

/// A selection with the words that say what it takes.
struct StarterSelection {
  Selection select;
  std::string words;  ///< "the lowest 5 %", "the group feet"
  std::size_t points = 0;
};

/// A body that can be filled, held and pulled, and why it is as it is.
struct StarterBody {
  BodySettings settings;  ///< placement and tetrahedra
  LoadedBody loaded;      ///< as it is placed
  std::string up_reason;  ///< a sentence
  std::string size_reason;
  std::string fill_reason;  ///< empty: the usual way did
  bool stands = true;       ///< held at its base; else it lies, and is held at one end
  StarterSelection held, pulled;
  double length = 0;       ///< m, the largest edge of its box
  double slenderness = 1;  ///< length over height, of one that lies
  double leg_share = 1;    ///< of one that stands: its thinnest section below the middle over the mean one, at most 1
  double volume = 0;       ///< m^3, of its tetrahedra
  std::size_t tets = 0;
  int pieces = 0, loose_pieces = 0;  ///< parts of the tetrahedra; those that nothing holds
};

/// Reads, checks and repairs the mesh, chooses, and fills it to see that it can be. `name`: of the body. Throws
/// input_error if the mesh cannot be read, has no such group, or cannot be filled in any of the ways that are tried.
StarterBody choose_body(const std::string& mesh, const std::string& name, const StarterWishes& wishes,
                        const RunContext& context);

}  // namespace softreel
