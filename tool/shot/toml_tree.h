/// A TOML document as plain values, each with the place it was written; what presets, overrides and the schema work on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tool/shot/shot.h"

namespace softreel {

struct TomlEntry;

/// A date or time: valid TOML that no field of a shot takes.
struct TomlDate {
  std::string text;
};

/// One value; tables keep the order of the file.
struct TomlValue {
  using Array = std::vector<TomlValue>;
  using Table = std::vector<TomlEntry>;

  std::variant<bool, std::int64_t, double, std::string, TomlDate, Array, Table> data;
  Origin origin;         ///< where the value starts
  bool section = false;  ///< written as [table] or [[table]] with lines of its own

  const Array* array() const { return std::get_if<Array>(&data); }
  Array* array() { return std::get_if<Array>(&data); }
  const Table* table() const { return std::get_if<Table>(&data); }
  Table* table() { return std::get_if<Table>(&data); }
  const std::string* text() const { return std::get_if<std::string>(&data); }

  /// The value under a key of a table; null if this is no table or has no such key.
  const TomlValue* find(std::string_view key) const;
  TomlValue* find(std::string_view key);
};

struct TomlEntry {
  std::string key;
  Origin key_origin;
  TomlValue value;
};

/// Wraps a plain value that was written nowhere.
template <typename T>
TomlValue toml_value(T value) {
  return TomlValue{std::move(value), {}, false};
}

/// An entry that was written nowhere.
TomlEntry toml_entry(std::string key, TomlValue value);

/// Reads a file. Throws input_error if it cannot be read or is no TOML, with line and column and what to do next.
TomlValue read_toml_file(const std::string& path);

/// Reads a document that `name` calls. Throws input_error if it is no TOML.
TomlValue parse_toml(std::string_view text, const std::string& name);

/// Reads one value, as on the right of an equals sign; none if the text is no TOML value.
std::optional<TomlValue> parse_toml_value(const std::string& text, const Origin& origin);

/// "a table", "text", "a whole number" ...: what a value is, for messages.
std::string kind_name(const TomlValue& value);

/// The value on one line, floats in the fewest digits that read back as the same number.
std::string to_text(const TomlValue& value);

/// The same, cut to what fits into a message.
std::string to_short_text(const TomlValue& value);

/// A key as TOML spells it: bare or quoted.
std::string key_text(const std::string& key);

/// A whole document: plain values first, then sections.
std::string to_document(const TomlValue& table);

}  // namespace softreel
