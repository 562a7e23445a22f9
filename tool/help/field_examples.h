/// An example of every field's value.
#pragma once

#include <string>

#include "tool/shot/schema.h"

namespace softreel {

/// A value as a shot could say it, as TOML: the default where there is one that can be written, else one of its type.
/// Of a table: empty.
std::string field_example(const FieldText& field);

}  // namespace softreel
