/// The layers of a shot made one document: presets first, then the file that names them, then overrides.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/shot_load.h"
#include "tool/shot/toml_tree.h"

namespace softreel {

/// Which layer's place of writing a table has that both have: the file to be corrected where it lacks something.
enum class Writing { OfLower, OfUpper };

/// Puts `over` on top of `base`: tables merge, anything else replaces; of fields that exclude each other the upper
/// layer's removes the lower layer's. Places of writing stay with the values. `pattern`: path of the two in the schema.
void merge_layer(TomlValue& base, TomlValue over, Writing tables, const std::string& pattern = {});

/// The file with the presets that it names in `use`, and those that they name, underneath; `use` itself is gone. On top
/// of it the file that an override of the path kQuality names, then the other overrides.
/// Throws input_error for files that cannot be read, cycles, and files written for a newer program.
TomlValue load_layers(const std::string& path, const std::vector<Override>& overrides);

/// Applies one override to the document. Throws input_error if its path leads nowhere, naming the nearest.
void apply_override(TomlValue& document, const Override& override_value);

/// The value of an override as TOML; a bare word is text. Throws input_error.
TomlValue parse_override_value(const Override& override_value);

}  // namespace softreel
