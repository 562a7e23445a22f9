/// Where the fields of the schema stand in the document of a shot.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/toml_tree.h"

namespace softreel {

/// A field by the names and positions that a document has.
struct FieldPlace {
  std::string path;                  ///< as --set takes it: "body.tets" of the only body, "light[0].power"
  const TomlValue* value = nullptr;  ///< in the document; null: it is not given there
};

/// Every place of a field: `pattern` is its path in the schema, "body.*.pin[].stiffness". In an empty document lists
/// count as having one entry, and the only body needs no name. The places point into the document.
std::vector<FieldPlace> field_places(const std::string& pattern, const TomlValue& document);

}  // namespace softreel
