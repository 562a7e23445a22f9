#include "tool/shot/schema.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

/// Without positions in lists: "pin[0].keys[].frame" and "pin.keys.frame" are the same.
std::string without_positions(const std::string& path) {
  std::string out;
  bool in_brackets = false;
  for (const char c : path) {
    if (c == '[') in_brackets = true;
    if (!in_brackets) out += c;
    if (c == ']') in_brackets = false;
  }
  return out;
}

/// The same path with '*' for the name that follows "body." or "material.".
std::string with_star(const std::string& path) {
  for (const std::string table : {"body.", "material."}) {
    if (path.rfind(table, 0) != 0) continue;
    const std::size_t dot = path.find('.', table.size());
    return dot == std::string::npos ? table.substr(0, table.size() - 1) : table + "*" + path.substr(dot);
  }
  return path;
}

const FieldText* find_exactly(const std::string& path) {
  for (const FieldText& text : field_texts())
    if (without_positions(text.path) == path) return &text;
  return nullptr;
}

/// The heading of a table as a file spells it: "[[body.NAME.pin]]".
std::string heading(const FieldText& table) {
  std::string path = table.path;
  for (std::size_t at = path.find('*'); at != std::string::npos; at = path.find('*')) path.replace(at, 1, "NAME");
  if (table.type == "tables by name") path += ".NAME";
  for (std::size_t at = path.find("[]"); at != std::string::npos; at = path.find("[]")) path.erase(at, 2);
  return table.type == "list of tables" ? fmt::format("[[{}]]", path) : fmt::format("[{}]", path);
}

/// Markdown tables split cells at bars.
std::string cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
    text.replace(at, 1, "\\|");
  return text;
}

/// How the paths of the fields directly in a table begin.
std::string inner_prefix(const FieldText& table) {
  if (table.type == "tables by name") return table.path + ".*.";
  return table.path + (table.type == "list of tables" ? "[]." : ".");
}

/// Tables with a heading of their own; those inside a selection are written in place.
bool has_heading(const FieldText& text) {
  return text.is_table && text.path.find("select") == std::string::npos;
}

void append_row(const FieldText& text, const std::string& prefix, std::string& out) {
  out += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", text.path.substr(prefix.size()), cell(text.type),
                     cell(text.unit), cell(text.default_value), cell(text.accepted), cell(text.sentence));
}

/// All fields whose innermost table with a heading is this one.
void append_rows(const FieldText* table, std::string& out) {
  const std::string prefix = table == nullptr ? "" : inner_prefix(*table);
  out += "\n| field | type | unit | default | accepted | meaning |\n|---|---|---|---|---|---|\n";
  for (const FieldText& text : field_texts()) {
    if (text.path.rfind(prefix, 0) != 0 || has_heading(text)) continue;
    bool deeper = false;
    for (const FieldText& other : field_texts()) {
      const bool inside = has_heading(other) && text.path.rfind(inner_prefix(other), 0) == 0;
      deeper = deeper || (inside && inner_prefix(other).size() > prefix.size());
    }
    if (!deeper) append_row(text, prefix, out);
  }
}

}  // namespace

const std::vector<FieldText>& field_texts() {
  static const std::vector<FieldText> texts = table_texts(shot_table(), "");
  return texts;
}

std::string shot_reference() {
  std::string out = "# Fields of a shot\n";
  append_rows(nullptr, out);
  for (const FieldText& text : field_texts()) {
    if (!has_heading(text)) continue;
    out += fmt::format("\n## `{}`\n\n{}\n", heading(text), text.sentence);
    append_rows(&text, out);
  }
  return out;
}

const FieldText* find_field(const std::string& path) {
  const std::string plain = without_positions(path);
  if (plain.rfind("body.", 0) == 0)  // body.FIELD: of the only body
    if (const FieldText* text = find_exactly("body.*." + plain.substr(5))) return text;
  return find_exactly(with_star(plain));
}

std::string explain_field(const std::string& path) {
  const FieldText* text = find_field(path);
  if (text == nullptr) {
    std::vector<std::string> known;
    for (const FieldText& one : field_texts()) known.push_back(without_positions(one.path));
    throw input_error(
        fmt::format("{} is wrong because a shot has no such field.\n  Accepted: a path such as body.*.tets or "
                    "camera.margin. Look it up in the reference of fields.{}",
                    path, suggestion(with_star(without_positions(path)), known)));
  }
  std::string out = fmt::format("{}: {}\n", text->path, text->sentence);
  if (text->is_table) {
    out += "  Fields:";
    const std::string prefix = inner_prefix(*text);
    for (const FieldText& one : field_texts())
      if (one.path.rfind(prefix, 0) == 0 && one.path.find_first_of(".[", prefix.size()) == std::string::npos)
        out += fmt::format(" {}", one.path.substr(prefix.size()));
    return out + "\n";
  }
  out += fmt::format("  Type: {}{}\n  Accepted: {}\n", text->type,
                     text->unit.empty() ? "" : fmt::format(", in {}", text->unit), text->accepted);
  if (!text->default_value.empty()) out += fmt::format("  Default: {}\n", text->default_value);
  return out;
}

}  // namespace softreel
