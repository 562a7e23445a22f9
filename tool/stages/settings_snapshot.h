/// What a shot said when a result was made, and how that differs from what it says now.
#pragma once

#include <string>
#include <vector>

#include "tool/outputs/outputs.h"
#include "tool/shot/shot.h"
#include "tool/shot/toml_tree.h"
#include "tool/stages/shot_run.h"

namespace softreel {

/// The whole shot as TOML with absolute paths, and a key of what each file that it reads says.
SettingsSnapshot snapshot(const ShotRun& run);

/// One place where two snapshots differ.
struct FieldChange {
  std::string field;          ///< "body.creature.pull[0].keys", or "content of FILE"
  bool is_mesh = false;       ///< the content of a mesh; else of a picture, where nothing can be undone
  std::string before, after;  ///< as TOML, in short; empty: the field was not there
  /// The newer document with this place as it was before; none where only a file's content differs.
  std::optional<TomlValue> undone;
};

/// All differences, fields in the order of the schema.
std::vector<FieldChange> find_changes(const SettingsSnapshot& before, const SettingsSnapshot& after);

}  // namespace softreel
