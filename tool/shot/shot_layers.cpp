#include "tool/shot/shot_layers.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include <fmt/ranges.h>

#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "tool/shot/codecs.h"
#include "tool/shot/plain_path.h"
#include "tool/shot/preset_library.h"
#include "tool/shot/schema.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

/// The path of a table's entry in the schema: names of bodies and materials become '*'.
std::string entry_pattern(const std::string& pattern, const std::string& key) {
  if (pattern == "body" || pattern == "material") return pattern + ".*";
  return pattern.empty() ? key : pattern + "." + key;
}

void erase_key(TomlValue& table, const std::string& key) {
  std::erase_if(*table.table(), [&key](const TomlEntry& entry) { return entry.key == key; });
}

/// A file named in `use`, with the files that named it, outermost first.
struct PresetChain {
  std::vector<std::string> files;  ///< as given
};

std::string real_path(const std::string& path) {
  std::error_code ignored;
  const auto real = std::filesystem::weakly_canonical(path, ignored);
  return ignored ? path : real.string();
}

/// Each file must be of a version that this program reads; which one wins in the merged document does not matter.
void check_schema_version(const TomlValue& document) {
  const TomlValue* schema = document.find("schema");
  if (schema == nullptr) return;
  const auto describes = [](const FieldText& text) { return text.path == "schema"; };
  const FieldText& text = *std::find_if(field_texts().begin(), field_texts().end(), describes);
  const Place place{"schema", &text, nullptr};
  if (parse_whole(place, *schema, 1, std::numeric_limits<std::int64_t>::max()) > kSchemaVersion)
    throw value_error(place, *schema, "the file is written for a newer softreel", "Use a newer softreel.");
}

/// The paths that `use` names, each with the place that names it.
std::vector<std::pair<std::string, Origin>> used_presets(const TomlValue& use) {
  const auto fail = [](const TomlValue& value, const std::string& why) {
    return input_error(
        fmt::format("{}: use = {} is wrong because {}.\n  Accepted: a list of paths of presets in quotes, "
                    "relative to the file that says them. Correct it.",
                    to_string(value.origin), to_short_text(value), why));
  };
  TomlValue::Array items;
  if (use.text() != nullptr)
    items.push_back(use);
  else if (use.array() != nullptr)
    items = *use.array();
  else
    throw fail(use, "it is " + kind_name(use));
  std::vector<std::pair<std::string, Origin>> presets;
  for (const TomlValue& item : items) {
    if (item.text() == nullptr || item.text()->empty()) throw fail(item, "it holds no path");
    const std::filesystem::path path = *item.text();
    const bool keep = item.origin.line == 0 || path.is_absolute();
    const auto folder = std::filesystem::path(item.origin.file).parent_path();
    presets.emplace_back(plain_path(keep ? path : folder / path).string(), item.origin);
  }
  return presets;
}

void check_cycle(const PresetChain& chain, const std::string& file, const Origin& origin) {
  const auto same = [&file](const std::string& other) { return real_path(other) == real_path(file); };
  const auto begin = std::find_if(chain.files.begin(), chain.files.end(), same);
  if (begin == chain.files.end()) return;
  std::string circle;
  for (auto it = begin; it != chain.files.end(); ++it) circle += *it + " uses ";
  throw input_error(
      fmt::format("{}: use = \"{}\" is wrong because presets use each other in a circle: {}{}.\n  Accepted: "
                  "files that do not lead back here. Remove one of these.",
                  to_string(origin), file, circle, file));
}

TomlValue load_file(const std::string& file, const TomlValue* use_instead, PresetChain& chain) {
  TomlValue own = read_toml_file(file);
  check_schema_version(own);
  chain.files.push_back(file);
  TomlValue document = toml_value(TomlValue::Table{});
  document.origin = {file, 1, 1};
  const TomlValue* use = use_instead != nullptr ? use_instead : own.find("use");
  if (use != nullptr)
    for (const auto& [preset, origin] : used_presets(*use)) {
      check_cycle(chain, preset, origin);
      std::error_code ignored;
      if (!std::filesystem::exists(preset, ignored))
        throw input_error(
            fmt::format("{}: use = \"{}\" is wrong because this file does not exist.\n  Accepted: the path of "
                        "a preset, relative to the file that says it. Correct the path.",
                        to_string(origin), preset));
      merge_layer(document, load_file(preset, nullptr, chain), Writing::OfUpper);
    }
  erase_key(own, "use");
  merge_layer(document, std::move(own), Writing::OfUpper);
  chain.files.pop_back();
  return document;
}

/// The layer that lies on top of the shot's own.
TomlValue load_quality(const std::string& name) {
  PresetChain chain;
  return load_file(quality_file(name), nullptr, chain);
}

/// A quality changes the shot's bodies and materials and adds none: of one more next to nothing would be said, and a
/// misspelt one would change nothing.
void check_names(const char* kind, const TomlValue& quality, const TomlValue& document, const char* built_in) {
  const TomlValue* changed = quality.find(kind);
  if (changed == nullptr || changed->table() == nullptr) return;
  std::vector<std::string> names;
  if (const TomlValue* there = document.find(kind); there != nullptr && there->table() != nullptr)
    for (const TomlEntry& one : *there->table()) names.push_back(one.key);
  if (names.empty() && built_in != nullptr) names.emplace_back(built_in);
  for (const TomlEntry& entry : *changed->table())
    if (std::find(names.begin(), names.end(), entry.key) == names.end())
      throw input_error(
          fmt::format("{0}: {1}.{2} is wrong because the shot that this quality is for has no such {1}.\n"
                      "  Accepted: {3}. Correct the name, or take the table out.{4}",
                      to_string(entry.value.origin), kind, entry.key,
                      names.empty() ? fmt::format("no {}'s table", kind) : fmt::format("{}", fmt::join(names, ", ")),
                      suggestion(entry.key, names)));
}

}  // namespace

void merge_layer(TomlValue& base, TomlValue over, Writing tables, const std::string& pattern) {
  for (const Alternatives& group : alternatives()) {
    if (group.table != pattern) continue;
    const auto given = [&over](const std::string& name) { return find_given(over, name) != nullptr; };
    if (std::any_of(group.fields.begin(), group.fields.end(), given))
      for (const std::string& name : group.fields) erase_key(base, name);
  }
  if (tables == Writing::OfUpper) base.origin = over.origin;
  for (TomlEntry& entry : *over.table()) {
    TomlValue* below = base.find(entry.key);
    if (below == nullptr) {
      base.table()->push_back(std::move(entry));
    } else if (below->table() != nullptr && entry.value.table() != nullptr) {
      merge_layer(*below, std::move(entry.value), tables, entry_pattern(pattern, entry.key));
    } else {
      *below = std::move(entry.value);
    }
  }
}

TomlValue load_layers(const std::string& path, const std::vector<Override>& overrides) {
  std::optional<TomlValue> use;
  for (const Override& one : overrides)
    if (one.path == "use") use = parse_override_value(one);
  PresetChain chain;
  TomlValue document = load_file(path, use ? &*use : nullptr, chain);
  for (const Override& one : overrides)
    if (one.path == kQuality) {
      TomlValue quality = load_quality(one.value);
      check_names("body", quality, document, nullptr);
      check_names("material", quality, document, "default");
      merge_layer(document, std::move(quality), Writing::OfLower);
    }
  for (const Override& one : overrides)
    if (one.path != "use" && one.path != kQuality) apply_override(document, one);
  return document;
}

}  // namespace softreel
