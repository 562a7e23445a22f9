#include "tool/shot/shot.h"

#include <fmt/format.h>

namespace softreel {

std::string to_string(const Origin& origin) {
  if (origin.line == 0) return origin.file;
  return fmt::format("{}:{}:{}", origin.file, origin.line, origin.column);
}

}  // namespace softreel
