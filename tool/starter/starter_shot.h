/// The first shot of a mesh: chosen, commented, and fit to be rendered as it is.
#pragma once

#include <string>
#include <vector>

#include "tool/starter/starter_choices.h"

namespace softreel {

struct StarterOptions {
  std::string mesh;    ///< path from the working directory
  std::string output;  ///< of the shot; paths in it are relative to its folder. Empty: the working directory
  std::string material = "rubber";  ///< of the library
  std::string like;             ///< a preset whose time, weight, camera, light, picture and motion are taken; or empty
  bool material_given = false;  ///< else that of `like`, if it is given
  StarterWishes wishes;
};

struct StarterShot {
  std::string text;                ///< TOML
  std::string name;                ///< of the body and of the shot's files
  std::vector<std::string> facts;  ///< what was found and chosen, a line each
};

/// Reads the mesh, chooses (starter_choices.h), and writes the shot, which is read back to be sure of it. Throws
/// input_error for a mesh that cannot be filled, and for unknown materials, presets and groups.
StarterShot make_starter_shot(const StarterOptions& options, const RunContext& context);

}  // namespace softreel
