#include "tool/help/field_explanation.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "tool/cache/json_text.h"
#include "tool/help/field_examples.h"
#include "tool/help/field_places.h"
#include "tool/shot/preset_library.h"
#include "tool/shot/schema_tables.h"
#include "tool/shot/shot_layers.h"

namespace softreel {
namespace {

constexpr std::size_t kMostRelated = 8;

/// "body.*.pin[]" of "body.*.pin[].keys".
std::string table_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

std::string last_name(const std::string& path) {
  std::string name = path.substr(path.rfind('.') + 1);
  return name.substr(0, name.find('['));
}

bool is_word_in(const std::string& word, const std::string& sentence) {
  const auto part_of_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = sentence.find(word); at != std::string::npos; at = sentence.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !part_of_word(sentence[at - 1])) && (end == sentence.size() || !part_of_word(sentence[end])))
      return true;
  }
  return false;
}

std::vector<std::string> excluded_by(const FieldText& text) {
  std::vector<std::string> names;
  for (const Alternatives& group : alternatives()) {
    const std::string name = last_name(text.path);
    const auto& fields = group.fields;
    if (group.table != table_of(text.path) || std::find(fields.begin(), fields.end(), name) == fields.end()) continue;
    for (const std::string& other : fields)
      if (other != name) names.push_back(group.table + "." + other);
  }
  return names;
}

/// Fields that speak of each other; names that are plain words of the language, such as "all", would find too much.
std::vector<std::string> related_to(const FieldText& text, const std::vector<std::string>& excluded) {
  std::vector<std::string> names;
  const std::string name = last_name(text.path);
  for (const FieldText& other : field_texts()) {
    if (other.path == text.path || table_of(other.path) != table_of(text.path)) continue;
    if (std::find(excluded.begin(), excluded.end(), other.path) != excluded.end()) continue;
    const std::string other_name = last_name(other.path);
    if (is_word_in(other_name, text.sentence) || is_word_in(name, other.sentence)) names.push_back(other.path);
    if (names.size() == kMostRelated) break;
  }
  return names;
}

std::vector<std::string> inside(const FieldText& table) {
  std::vector<std::string> names;
  const std::string prefix = table.path + (table.type == "tables by name"   ? ".*."
                                           : table.type == "list of tables" ? "[]."
                                                                            : ".");
  for (const FieldText& one : field_texts())
    if (one.path.starts_with(prefix) && one.path.find_first_of(".[", prefix.size()) == std::string::npos)
      names.push_back(one.path.substr(prefix.size()));
  return names;
}

/// The field of a path, or of a last name that is the only one.
const FieldText& find_or_throw(const std::string& path) {
  if (const FieldText* text = find_field(path)) return *text;
  std::vector<const FieldText*> namesakes;
  std::vector<std::string> paths, names;
  for (const FieldText& text : field_texts()) {
    if (last_name(text.path) == path) namesakes.push_back(&text);
    paths.push_back(text.path);
    names.push_back(last_name(text.path));
  }
  if (namesakes.size() == 1) return *namesakes.front();
  std::vector<std::string> meant;
  for (const FieldText* text : namesakes) meant.push_back(text->path);
  if (!meant.empty())
    throw input_error(fmt::format("{}: several fields have this name.\n  Accepted: {}. Name one of them.", path,
                                  fmt::join(meant, ", ")));
  std::string nearest = nearest_name(path, paths);
  if (nearest.empty() && path.find('.') == std::string::npos) nearest = nearest_name(path, names);
  if (nearest.empty()) {  // the last name may be right, or nearly so, in a table that is not
    const std::string near_name = nearest_name(last_name(path), names);
    const auto found = std::find(names.begin(), names.end(), near_name);
    if (!near_name.empty()) nearest = paths[static_cast<std::size_t>(found - names.begin())];
  }
  throw input_error(
      fmt::format("{}: a shot has no such field.\n  Accepted: a path such as body.*.tets, camera.margin or its last "
                  "name, or a topic.{} softreel fields lists all.",
                  path, nearest.empty() ? "" : fmt::format(" Did you mean {}?", nearest)));
}

/// Whether the path is one of a shot rather than of the schema: it names what `*` and `[]` stand for.
bool is_place(const std::string& path, const std::vector<FieldPlace>& places) {
  return std::any_of(places.begin(), places.end(), [&path](const FieldPlace& place) { return place.path == path; });
}

std::string without_positions(std::string path) {
  for (std::size_t at = path.find('['); at != std::string::npos; at = path.find('['))
    path.erase(at, path.find(']', at) - at + 1);
  return path;
}

/// The ways to write a place: with and without the name of its body and positions. bodies: names of the shot.
std::vector<std::string> spellings(const std::string& place, const std::vector<std::string>& bodies) {
  std::vector<std::string> all{place};
  for (const std::string& body : bodies) {
    const std::string name = "body." + body + ".";
    if (place.starts_with(name)) all.push_back("body." + place.substr(name.size()));
    if (place.starts_with("body.") && bodies.size() == 1) all.push_back(name + place.substr(5));
  }
  const std::size_t count = all.size();
  for (std::size_t i = 0; i < count; ++i) all.push_back(without_positions(all[i]));
  return all;
}

std::vector<std::string> body_names(const TomlValue& document) {
  std::vector<std::string> names;
  const TomlValue* bodies = document.find("body");
  if (bodies == nullptr || bodies->table() == nullptr) return names;
  for (const TomlEntry& entry : *bodies->table()) names.push_back(key_text(entry.key));
  return names;
}

/// Throws if the path names a body, a material or a position that the shot does not have. A path of the schema, and one
/// with * or [], stands for all places, of which there may be none.
void require_place(const std::string& path, const FieldText& text, const std::vector<FieldPlace>& places,
                   const std::vector<std::string>& bodies, const std::string& shot) {
  if (path == last_name(text.path) || without_positions(path) == without_positions(text.path)) {
    const bool has_number = path.find('[') != std::string::npos && path.find("[]") == std::string::npos;
    if (!has_number) return;
  }
  if (path.find('*') != std::string::npos || path.find("[]") != std::string::npos) return;
  std::vector<std::string> known;
  for (const FieldPlace& place : places) {
    const std::vector<std::string> all = spellings(place.path, bodies);
    if (std::find(all.begin(), all.end(), path) != all.end()) return;
    if (known.size() < kMostRelated) known.push_back(place.path);
  }
  if (text.path.starts_with("body.*.") && path == "body." + text.path.substr(7)) return;  // of all bodies
  throw input_error(fmt::format(
      "{}: {} has no {}.\n  Accepted: {}. Name one of the shot's, or {} for all.", path, shot, table_of(path),
      known.empty() ? "nothing, the shot has no table for this field" : fmt::format("{}", fmt::join(known, ", ")),
      text.path));
}

/// How a file spells the heading of the table that holds the field.
std::string heading_of(const FieldText& text) {
  std::string table = table_of(text.path);
  const bool is_list = table.ends_with("[]");
  for (std::size_t at = table.find('*'); at != std::string::npos; at = table.find('*')) table.replace(at, 1, "NAME");
  for (std::size_t at = table.find("[]"); at != std::string::npos; at = table.find("[]")) table.erase(at, 2);
  if (table.empty()) return "";
  return is_list ? fmt::format("[[{}]]", table) : fmt::format("[{}]", table);
}

/// True for fields of values that are written in place: keys and selections.
bool is_inside_value(const FieldText& text) {
  const std::string table = table_of(text.path);
  for (const FieldText& other : field_texts()) {
    const bool holds = other.path == table || other.path + "[]" == table;
    if (holds) return !other.is_table || table.find("select") != std::string::npos;
  }
  return false;
}

/// --set with the example: a value of several words in quotes of the shell.
std::string set_example(const FieldText& text, const std::string& example) {
  const std::vector<FieldPlace> places = field_places(text.path, toml_value(TomlValue::Table{}));
  std::string path = places.empty() ? text.path : places.front().path;
  for (std::size_t at = path.find('*'); at != std::string::npos; at = path.find('*')) path.replace(at, 1, "NAME");
  const bool plain = example.find_first_of(" \"'[]{}") == std::string::npos && path.find('[') == std::string::npos;
  return plain ? fmt::format("--set {}={}", path, example) : fmt::format("--set '{}={}'", path, example);
}

/// Which layer a value was written in (`softreel explain layers`).
const char* layer_of(const Origin& origin, const std::string& shot, const std::vector<Override>& overrides) {
  if (origin.line == 0) return "--set";
  const auto is_in = [&origin](const std::string& file) {
    return std::filesystem::path(origin.file).lexically_normal() == std::filesystem::path(file).lexically_normal();
  };
  if (is_in(shot)) return "the shot itself";
  const auto names_it = [&](const Override& one) { return one.path == kQuality && is_in(quality_file(one.value)); };
  return std::any_of(overrides.begin(), overrides.end(), names_it) ? "--quality" : "a preset that it uses";
}

}  // namespace

FieldExplanation explain(const std::string& path) {
  FieldExplanation explanation;
  explanation.text = find_or_throw(path);
  explanation.example = field_example(explanation.text);
  explanation.instead = excluded_by(explanation.text);
  explanation.related = related_to(explanation.text, explanation.instead);
  if (explanation.text.is_table) explanation.inner = inside(explanation.text);
  return explanation;
}

std::vector<FieldValue> field_values_in(const std::string& path, const FieldText& text, const std::string& shot,
                                        const std::vector<Override>& overrides) {
  const TomlValue document = load_layers(shot, overrides);
  const std::vector<FieldPlace> places = field_places(text.path, document);
  require_place(path, text, places, body_names(document), shot);
  const bool one_only = is_place(path, places);
  std::vector<FieldValue> values;
  for (const FieldPlace& place : places) {
    if (one_only && place.path != path) continue;
    if (place.value == nullptr) {
      values.push_back({place.path, "", "", "default"});
      continue;
    }
    const Origin& origin = place.value->origin;
    values.push_back({place.path, to_text(*place.value), to_string(origin), layer_of(origin, shot, overrides)});
  }
  return values;
}

std::string to_text(const FieldExplanation& explanation) {
  const FieldText& text = explanation.text;
  std::string out = fmt::format("{}: {}\n", text.path, text.sentence);
  if (text.is_table) {
    out += fmt::format("  Fields: {}\n", fmt::join(explanation.inner, ", "));
    return out + fmt::format("  Example: softreel explain {}.{}\n", text.path,
                             explanation.inner.empty() ? "..." : explanation.inner.front());
  }
  out += fmt::format("  Type: {}\n  Unit: {}\n  Accepted: {}\n", text.type, text.unit.empty() ? "none" : text.unit,
                     text.accepted);
  if (text.required)
    out += "  Default: none, it must be given\n";
  else if (!text.default_value.empty())
    out += fmt::format("  Default: {}\n", text.default_value);
  if (!explanation.instead.empty()) out += fmt::format("  Instead of: {}\n", fmt::join(explanation.instead, ", "));
  const std::string heading = heading_of(text);
  out += fmt::format("  Example: {}{} = {}\n", heading.empty() || is_inside_value(text) ? "" : heading + " ",
                     last_name(text.path), explanation.example);
  if (!is_inside_value(text) && text.path != "schema")
    out += fmt::format("           {}\n", set_example(text, explanation.example));
  if (!explanation.related.empty()) out += fmt::format("  See also: {}\n", fmt::join(explanation.related, ", "));
  return out;
}

std::string to_text(const std::vector<FieldValue>& values, const FieldText& text, const std::string& shot) {
  std::string out = fmt::format("  In {}:\n", shot);
  if (values.empty()) out += "    it has no table for this field\n";
  for (const FieldValue& value : values) {
    if (value.where.empty())
      out += fmt::format("    {} is not given{}\n", value.path,
                         text.required                ? ""
                         : text.default_value.empty() ? ""
                                                      : "; default: " + text.default_value);
    else if (value.layer == "--set")
      out += fmt::format("    {} = {}  (--set)\n", value.path, value.value);
    else
      out += fmt::format("    {} = {}  ({}, {})\n", value.path, value.value, value.where, value.layer);
  }
  return out;
}

std::string to_json(const FieldExplanation& explanation, const std::vector<FieldValue>& values) {
  const FieldText& text = explanation.text;
  nlohmann::ordered_json json = {{"path", text.path},
                                 {"sentence", text.sentence},
                                 {"type", text.type},
                                 {"unit", text.unit},
                                 {"accepted", text.accepted},
                                 {"default", text.default_value},
                                 {"required", text.required},
                                 {"example", explanation.example},
                                 {"instead_of", explanation.instead},
                                 {"see_also", explanation.related},
                                 {"fields", explanation.inner}};
  json["values"] = nlohmann::ordered_json::array();
  for (const FieldValue& value : values)
    json["values"].push_back(
        {{"path", value.path}, {"value", value.value}, {"where", value.where}, {"layer", value.layer}});
  return json_text(json);
}

}  // namespace softreel
