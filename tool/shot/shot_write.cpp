#include <fmt/format.h>

#include "tool/shot/schema_tables.h"
#include "tool/shot/shot_load.h"

namespace softreel {

TomlValue to_tree(const Shot& shot) {
  return write_table(shot_table(), shot);
}

std::string to_toml(const Shot& shot) {
  return to_document(to_tree(shot));
}

}  // namespace softreel
