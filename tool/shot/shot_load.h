/// Reads and checks a shot: its file, the presets it uses, and --set.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/shot.h"
#include "tool/shot/toml_tree.h"

namespace softreel {

/// One --set PATH=VALUE of the command line, or one value of an option like it. `body.FIELD` addresses the only body of
/// a shot.
struct Override {
  std::string path;
  std::string value;             ///< TOML; a bare word that is no TOML value is taken as a string
  std::string option = "--set";  ///< that gave it, as messages name it
};

/// Path of an override that is no field: its value names a file whose values win over the shot's own (--quality), as
/// quality_file() finds it.
inline constexpr const char* kQuality = "quality";

/// Splits "path=value". Throws input_error if there is no '='.
Override parse_override(const std::string& text);

/// The path of an override of this shot in one spelling, the name of the only body in it. Throws input_error for what
/// is no path.
std::string full_path(const Override& one, const Shot& shot);

/// Reads a shot; presets named in `use` come first, then the file's own values, then those of kQuality's file, then the
/// overrides. Paths in a file are relative to it, paths in overrides to the working directory. Throws input_error with
/// file, line and column, the value, what is accepted, and the nearest known name for unknown ones.
Shot load_shot(const std::string& path, const std::vector<Override>& overrides);

/// The shot of a whole document, with presets and overrides in it; `path` names it in messages. Throws input_error.
Shot parse_shot(const std::string& path, const TomlValue& document);

/// The shot as a document with every field written out: parsing it gives the same shot.
TomlValue to_tree(const Shot& shot);

/// The shot as TOML with every field written out: loading it gives the same shot.
std::string to_toml(const Shot& shot);

}  // namespace softreel
