/// Visible properties that a shot may give as one value or as keys.
#pragma once

#include <string>

#include "tool/shot/codecs.h"
#include "tool/shot/schema_table.h"

namespace softreel {

/// Adds a number of an Appearance to the table of materials: a value, or a list of keys { frame, value, ease }.
void add_keyed(Table<MaterialSettings>& table, const std::string& name, float Appearance::*member, const Range& range,
               const std::string& unit, const std::string& meaning);

/// The same for a colour.
void add_keyed(Table<MaterialSettings>& table, const std::string& name, Vec3f Appearance::*member, const Range& range,
               const std::string& unit, const std::string& meaning);

}  // namespace softreel
