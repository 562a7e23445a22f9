#include "tool/shot/toml_tree.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
// toml++ 3.3 asserts that a key follows in headings such as [=], and then reports that it does not: only the report
// helps.
#define TOML_ASSERT(condition) static_assert(true)
#include <toml++/toml.h>

#include "core/base/error.h"

namespace softreel {
namespace {

constexpr std::size_t kShortText = 60;

Origin origin_of(const toml::source_region& source, const std::string& file) {
  return {file, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column)};
}

TomlValue convert(const toml::node& node, const std::string& file);

TomlValue::Table convert_table(const toml::table& table, const std::string& file) {
  TomlValue::Table entries;
  for (const auto& [key, value] : table)
    entries.push_back({std::string(key.str()), origin_of(key.source(), file), convert(value, file)});
  // toml++ sorts by name; bodies and materials keep the order of the file.
  std::stable_sort(entries.begin(), entries.end(), [](const TomlEntry& a, const TomlEntry& b) {
    return std::pair(a.key_origin.line, a.key_origin.column) < std::pair(b.key_origin.line, b.key_origin.column);
  });
  return entries;
}

TomlValue convert(const toml::node& node, const std::string& file) {
  TomlValue value;
  value.origin = origin_of(node.source(), file);
  if (const auto* flag = node.as_boolean()) {
    value.data = flag->get();
  } else if (const auto* whole = node.as_integer()) {
    value.data = static_cast<std::int64_t>(whole->get());
  } else if (const auto* number = node.as_floating_point()) {
    value.data = number->get();
  } else if (const auto* text = node.as_string()) {
    value.data = text->get();
  } else if (const auto* array = node.as_array()) {
    TomlValue::Array items;
    for (const toml::node& item : *array) items.push_back(convert(item, file));
    value.data = std::move(items);
  } else if (const auto* table = node.as_table()) {
    value.data = convert_table(*table, file);
  } else {
    std::ostringstream out;
    node.visit([&out](const auto& any) { out << any; });
    value.data = TomlDate{out.str()};
  }
  return value;
}

std::string read_text(const std::string& path) {
  const auto fail = [&path](const std::string& why) {
    return input_error(fmt::format(
        "{}: cannot be read: {}.\n  Accepted: a TOML file that you may read. Check the spelling of the path and the "
        "folder it is relative to.",
        path, why));
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw fail(std::strerror(EISDIR));
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw fail(std::strerror(errno != 0 ? errno : EIO));
  std::ostringstream out;
  out << in.rdbuf();
  if (in.bad() || out.bad()) throw fail(std::strerror(EIO));
  return std::move(out).str();
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\u{:04X}", byte);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string number_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  if (value == 0 && std::signbit(value)) return "-0.0";
  return fmt::format("{}", value);
}

struct TextOf {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const { return number_text(value); }
  std::string operator()(const std::string& value) const { return quoted(value); }
  std::string operator()(const TomlDate& value) const { return value.text; }
  std::string operator()(const TomlValue::Array& items) const {
    std::string out;
    for (const TomlValue& item : items) out += (out.empty() ? "" : ", ") + to_text(item);
    return "[" + out + "]";
  }
  std::string operator()(const TomlValue::Table& entries) const {
    std::string out;
    for (const TomlEntry& entry : entries)
      out += (out.empty() ? "" : ", ") + key_text(entry.key) + " = " + to_text(entry.value);
    return out.empty() ? "{}" : "{ " + out + " }";
  }
};

void append_section(const TomlValue::Table& entries, const std::string& path, std::string& out) {
  for (const TomlEntry& entry : entries)
    if (!entry.value.section) out += key_text(entry.key) + " = " + to_text(entry.value) + "\n";
  for (const TomlEntry& entry : entries) {
    if (!entry.value.section) continue;
    const std::string name = path.empty() ? key_text(entry.key) : path + "." + key_text(entry.key);
    if (const auto* items = entry.value.array()) {
      for (const TomlValue& item : *items) {
        out += fmt::format("\n[[{}]]\n", name);
        append_section(*item.table(), name, out);
      }
    } else {
      const TomlValue::Table& inner = *entry.value.table();
      // [body] alone says nothing where [body.NAME] follows.
      const bool only_sections = !inner.empty() && std::all_of(inner.begin(), inner.end(),
                                                               [](const TomlEntry& one) { return one.value.section; });
      if (!only_sections) out += fmt::format("\n[{}]\n", name);
      append_section(inner, name, out);
    }
  }
}

}  // namespace

const TomlValue* TomlValue::find(std::string_view key) const {
  if (table() == nullptr) return nullptr;
  for (const TomlEntry& entry : *table())
    if (entry.key == key) return &entry.value;
  return nullptr;
}

TomlValue* TomlValue::find(std::string_view key) {
  return const_cast<TomlValue*>(std::as_const(*this).find(key));
}

TomlEntry toml_entry(std::string key, TomlValue value) {
  return {std::move(key), Origin(), std::move(value)};
}

TomlValue read_toml_file(const std::string& path) {
  return parse_toml(read_text(path), path);
}

TomlValue parse_toml(std::string_view text, const std::string& name) {
  try {
    return convert(toml::parse(text, std::string_view(name)), name);
  } catch (const toml::parse_error& error) {
    const Origin origin = origin_of(error.source(), name);
    throw input_error(fmt::format(
        "{}: this is no TOML: {}.\n  Accepted: lines of FIELD = VALUE, under headings such as [body.NAME] or "
        "[[light]]. Correct the text at this place.",
        to_string(origin), error.description()));
  }
}

std::optional<TomlValue> parse_toml_value(const std::string& text, const Origin& origin) {
  try {
    const toml::table table = toml::parse("v = " + text);
    if (table.size() != 1) return std::nullopt;
    TomlValue value = convert(*table.get("v"), origin.file);
    const auto place = [&origin](auto&& self, TomlValue& at) -> void {
      at.origin = origin;
      if (auto* items = at.array())
        for (TomlValue& item : *items) self(self, item);
      if (auto* entries = at.table())
        for (TomlEntry& entry : *entries) {
          entry.key_origin = origin;
          self(self, entry.value);
        }
    };
    place(place, value);
    return value;
  } catch (const toml::parse_error&) {
    return std::nullopt;
  }
}

std::string kind_name(const TomlValue& value) {
  static constexpr const char* kNames[] = {"true or false", "a whole number", "a number", "text",
                                           "a date",        "a list",         "a table"};
  return kNames[value.data.index()];
}

std::string to_text(const TomlValue& value) {
  return std::visit(TextOf{}, value.data);
}

std::string to_short_text(const TomlValue& value) {
  std::string text = to_text(value);
  if (text.size() <= kShortText) return text;
  std::size_t end = kShortText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // not inside a UTF-8 character
  return text.substr(0, end) + " ...";
}

std::string key_text(const std::string& key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  return bare ? key : quoted(key);
}

std::string to_document(const TomlValue& table) {
  std::string out;
  append_section(*table.table(), "", out);
  return out;
}

}  // namespace softreel
