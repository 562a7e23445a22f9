#include "tool/cache/json_text.h"

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

bool is_utf8(const std::string& text) {
  try {
    (void)nlohmann::ordered_json(text).dump();
    return true;
  } catch (const nlohmann::ordered_json::type_error&) {
    return false;
  }
}

}  // namespace

std::string record_text(const nlohmann::ordered_json& json, int indent, const std::string& whose,
                        const std::string& what) {
  try {
    return json.dump(indent) + "\n";
  } catch (const nlohmann::ordered_json::type_error&) {
    throw input_error(
        fmt::format("{}: {} is UTF-8, and a path, a name or a --set of this shot is not.\n  Rename the file or folder.",
                    whose, what));
  }
}

void require_utf8(const std::string& name, const std::string& what) {
  if (is_utf8(name)) return;
  throw input_error(fmt::format("{}: {} is not UTF-8.\n  Accepted: UTF-8, as the files that hold it are. Rename it.",
                                json_text(name), what));
}

}  // namespace softreel
