/// JSON as the program prints it.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace softreel {

/// Indented text. Names out of mesh files may hold bytes that are no UTF-8, which JSON cannot carry: U+FFFD stands for
/// each of them.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace softreel
