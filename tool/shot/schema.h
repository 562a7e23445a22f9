/// The one table of a shot's fields: reading, checking, writing, reference and completion come from it.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// Version of the fields that this program reads: `schema = 1` in a shot.
inline constexpr int kSchemaVersion = 1;

/// What the table says of one field. `*` in a path stands for a name, `[]` for a position in a list.
struct FieldText {
  std::string path;           ///< "body.*.pin[].stiffness"
  std::string type;           ///< "number", "[x, y, z]", "table"
  std::string unit;           ///< "m"; empty: none
  std::string default_value;  ///< as TOML, or in words; empty: none
  std::string accepted;       ///< "above 0"
  std::string sentence;
  bool is_table = false;  ///< holds the fields whose paths continue its own
  bool required = false;
};

/// Descriptions of all fields, tables before what they hold.
const std::vector<FieldText>& field_texts();

/// The reference of all fields, as Markdown.
std::string shot_reference();

/// What the table says of a field, named as for explain_field; null if there is none.
const FieldText* find_field(const std::string& path);

/// What one field is for, on a few lines. Takes a path of the table or one of a shot: "body.*.tets", "body.tets",
/// "body.creature.pin[0].keys[1].translate", "camera". Throws input_error for an unknown path, naming the nearest.
std::string explain_field(const std::string& path);

}  // namespace softreel
