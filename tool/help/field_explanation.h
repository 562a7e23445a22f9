/// What a field of a shot means, how it is written, and what a given shot says of it and where.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/schema.h"
#include "tool/shot/shot_load.h"

namespace softreel {

/// What a shot says of a field at one place.
struct FieldValue {
  std::string path;   ///< as --set takes it
  std::string value;  ///< as TOML; empty: not given, the default holds
  std::string where;  ///< "FILE:LINE:COLUMN", "--set"; empty: not given
  std::string layer;  ///< "the shot itself", "a preset that it uses", "--set", "default"
};

struct FieldExplanation {
  FieldText text;
  std::string example;               ///< as TOML; empty: of tables
  std::vector<std::string> instead;  ///< fields that exclude this one
  std::vector<std::string> related;  ///< fields of the same table that speak of it, or that it speaks of
  std::vector<std::string> inner;    ///< of tables: the fields directly in it
};

/// Explains a field named as for explain_field, or by its last name where that is the only one ("tets"). Throws
/// input_error for an unknown one, naming the nearest, and for a last name that several fields have, naming them.
FieldExplanation explain(const std::string& path);

/// What a shot says of the field, in every place where it can: an entry for each body, pin, light ... If `path` names a
/// place (body.creature.tets), of that only. Throws input_error if the shot cannot be read.
std::vector<FieldValue> field_values_in(const std::string& path, const FieldText& text, const std::string& shot,
                                        const std::vector<Override>& overrides);

std::string to_text(const FieldExplanation& explanation);
std::string to_text(const std::vector<FieldValue>& values, const FieldText& text, const std::string& shot);
std::string to_json(const FieldExplanation& explanation, const std::vector<FieldValue>& values);

}  // namespace softreel
