/// JSON as the program prints and keeps it.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace softreel {

/// Indented text. Names out of mesh files may hold bytes that are no UTF-8, which JSON cannot carry: U+FFFD stands for
/// each of them.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// Indented text that is read again, so that no byte may be replaced, with its line end. `whose` and `what` say of
/// which shot and what the text is, should a path or a name in it be no UTF-8. Throws input_error then.
std::string record_text(const nlohmann::ordered_json& json, int indent, const std::string& whose,
                        const std::string& what);

/// Throws input_error if the text is no UTF-8: before a name, `what`, gets into a record that cannot carry it.
void require_utf8(const std::string& name, const std::string& what);

}  // namespace softreel
