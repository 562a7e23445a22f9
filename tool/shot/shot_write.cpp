#include <fmt/format.h>

#include "tool/shot/schema_tables.h"
#include "tool/shot/shot_load.h"

namespace softreel {

std::string to_toml(const Shot& shot) {
  return to_document(write_table(shot_table(), shot));
}

}  // namespace softreel
