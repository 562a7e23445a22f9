// Overrides: where their paths lead in a document, and what they put there.
#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "tool/shot/schema_tables.h"
#include "tool/shot/shot_layers.h"

namespace softreel {
namespace {

Origin origin_of(const Override& one) {
  return {one.option, 0, 0};
}

/// One step of a path: a key, or a position in a list.
struct Step {
  std::string key;
  std::size_t index = 0;
  bool is_index = false;
};

Error override_error(const Override& one, const std::string& why, const std::string& accepted,
                     const std::string& next) {
  return input_error(fmt::format("{}: {} = {} is wrong because {}.\n  Accepted: {}. {}", one.option, one.path,
                                 one.value, why, accepted, next));
}

Error path_syntax_error(const Override& one) {
  return override_error(one, "its path cannot be read",
                        "names joined by dots, positions in brackets: body.NAME.pin[0].keys",
                        "Correct the path; put names with other characters into double quotes.");
}

/// Reads "[12]" at `at`.
Step index_step(const Override& one, std::size_t& at) {
  const std::size_t close = one.path.find(']', at);
  const std::string digits = close == std::string::npos ? "" : one.path.substr(at + 1, close - at - 1);
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  if (digits.empty() || digits.size() > 9 || !std::all_of(digits.begin(), digits.end(), is_digit))
    throw path_syntax_error(one);
  at = close + 1;
  return {"", std::stoul(digits), true};
}

/// Reads a bare or quoted name at `at`.
Step key_step(const Override& one, std::size_t& at) {
  const bool quoted = at < one.path.size() && one.path[at] == '"';
  const std::size_t begin = quoted ? at + 1 : at;
  const std::size_t end =
      quoted ? one.path.find('"', begin) : std::min(one.path.find_first_of(".[]\"", begin), one.path.size());
  if (end == std::string::npos || end == begin) throw path_syntax_error(one);
  at = quoted ? end + 1 : end;
  return {one.path.substr(begin, end - begin), 0, false};
}

std::vector<Step> parse_steps(const Override& one) {
  std::vector<Step> steps;
  std::size_t at = 0;
  steps.push_back(key_step(one, at));
  while (at < one.path.size()) {
    if (one.path[at] == '[') {
      steps.push_back(index_step(one, at));
    } else if (one.path[at] == '.') {
      steps.push_back(key_step(one, ++at));
    } else {
      throw path_syntax_error(one);
    }
  }
  return steps;
}

std::vector<std::string> keys_of(const TomlValue* table) {
  std::vector<std::string> keys;
  if (table != nullptr && table->table() != nullptr)
    for (const TomlEntry& entry : *table->table()) keys.push_back(entry.key);
  return keys;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// `body.FIELD` means the only body: puts its name in between.
void name_the_body(const std::vector<std::string>& bodies, const Override& one, std::vector<Step>& steps) {
  if (steps.size() < 2 || steps[0].key != "body" || steps[1].is_index) return;
  const std::vector<std::string> fields = body_table().names();
  if (bodies.empty() || (contains(bodies, steps[1].key) && steps.size() > 2)) return;
  if (contains(fields, steps[1].key) && bodies.size() == 1) {
    steps.insert(steps.begin() + 1, Step{bodies.front(), 0, false});
    return;
  }
  if (contains(fields, steps[1].key))
    throw override_error(one, fmt::format("the shot has {} bodies", bodies.size()),
                         fmt::format("{}", fmt::join(bodies, ", ")),
                         fmt::format("Name the body: body.{}.{}", key_text(bodies.front()), steps[1].key));
  if (contains(bodies, steps[1].key)) return;  // the whole table of a body: refused where its value is read
  std::vector<std::string> known = bodies;
  known.insert(known.end(), fields.begin(), fields.end());
  throw override_error(one, fmt::format("there is neither a body nor a field of a body named {}", steps[1].key),
                       fmt::format("{}", fmt::join(known, ", ")),
                       "Correct the path." + suggestion(steps[1].key, known));
}

/// A misspelt material would be made and never used.
void check_material_exists(const TomlValue& document, const Override& one, const std::vector<Step>& steps) {
  if (steps.size() < 2 || steps[0].key != "material" || steps[1].is_index) return;
  std::vector<std::string> names = keys_of(document.find("material"));
  if (names.empty()) names.emplace_back("default");  // the built-in one
  if (contains(names, steps[1].key)) return;
  throw override_error(one, "there is no material named " + steps[1].key, fmt::format("{}", fmt::join(names, ", ")),
                       "Correct the path." + suggestion(steps[1].key, names));
}

/// The entry that one step leads to; tables that are not there yet are made.
TomlValue& follow(TomlValue& at, const Step& step, const Override& one, const std::string& walked) {
  if (step.is_index) {
    auto* items = at.array();
    const std::size_t count = items == nullptr ? 0 : items->size();
    if (step.index < count) return (*items)[step.index];
    throw override_error(one, fmt::format("{} has {} entries", walked, count),
                         count == 0 ? "no position" : fmt::format("positions 0 to {}", count - 1),
                         "Correct the position, or set the whole list.");
  }
  if (at.table() == nullptr)
    throw override_error(one, fmt::format("{} is {}", walked, kind_name(at)), "a path that leads through tables",
                         at.array() != nullptr ? "Say which entry: " + walked + "[0]." : "Shorten the path.");
  if (TomlValue* found = at.find(step.key)) return *found;
  TomlValue made = toml_value(TomlValue::Table{});
  made.origin = origin_of(one);
  at.table()->push_back({step.key, origin_of(one), std::move(made)});
  return at.table()->back().value;
}

/// Adds a step to a path.
void walk(const Step& step, std::string& path) {
  path += step.is_index ? fmt::format("[{}]", step.index)
                        : fmt::format("{}{}", path.empty() ? "" : ".", key_text(step.key));
}

/// Removes the fields that the one which is set excludes.
void erase_alternatives(TomlValue& table, const std::string& pattern, const std::string& key) {
  for (const Alternatives& group : alternatives())
    if (group.table == pattern && contains(group.fields, key))
      std::erase_if(*table.table(), [&](const TomlEntry& entry) { return contains(group.fields, entry.key); });
}

/// Whether the text is meant as a word rather than as a TOML value with a mistake in it.
bool is_bare_word(const std::string& text) {
  const bool printable = std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= 0x20 && c != 0x7f; });
  return !text.empty() && printable && text.find_first_of("\"'[]{},=#") == std::string::npos;
}

}  // namespace

Override parse_override(const std::string& text) {
  const std::size_t equals = text.find('=');
  const auto trimmed = [](const std::string& part) {
    const std::size_t first = part.find_first_not_of(" \t"), last = part.find_last_not_of(" \t");
    return first == std::string::npos ? std::string() : part.substr(first, last - first + 1);
  };
  if (equals == std::string::npos || trimmed(text.substr(0, equals)).empty())
    throw input_error(
        fmt::format("--set: {} is wrong because it is not of the form PATH=VALUE.\n  Accepted: a field and its "
                    "value, such as body.tets=5000. Correct it.",
                    text));
  return {trimmed(text.substr(0, equals)), trimmed(text.substr(equals + 1))};
}

TomlValue parse_override_value(const Override& override_value) {
  auto value = parse_toml_value(override_value.value, origin_of(override_value));
  if (value && !std::holds_alternative<TomlDate>(value->data)) return std::move(*value);
  if (!value && !is_bare_word(override_value.value))
    throw override_error(
        override_value, "the value is neither TOML nor a bare word",
        "a value as in a shot: 0.5, true, [0, 1, 0], \"text\", or a word without quotes",
        "Put text with special characters into double quotes, and all into single quotes of the shell.");
  TomlValue word = toml_value(override_value.value);
  word.origin = origin_of(override_value);
  return word;
}

std::string full_path(const Override& one, const Shot& shot) {
  std::vector<Step> steps = parse_steps(one);
  std::vector<std::string> bodies;
  for (const BodySettings& body : shot.bodies) bodies.push_back(body.name);
  name_the_body(bodies, one, steps);
  std::string path;
  for (const Step& step : steps) walk(step, path);
  return path;
}

void apply_override(TomlValue& document, const Override& override_value) {
  std::vector<Step> steps = parse_steps(override_value);
  name_the_body(keys_of(document.find("body")), override_value, steps);
  check_material_exists(document, override_value, steps);
  TomlValue value = parse_override_value(override_value);
  TomlValue* at = &document;
  std::string walked, pattern;
  for (const Step& step : steps) {
    const bool named = pattern == "body" || pattern == "material";
    const bool is_off = std::holds_alternative<bool>(value.data) && !std::get<bool>(value.data);
    if (at != &document) at->origin.changed_by = override_value.option;
    if (&step == &steps.back() && !step.is_index && at->table() != nullptr && !is_off)
      erase_alternatives(*at, pattern, step.key);
    at = &follow(*at, step, override_value, walked);
    walk(step, walked);
    if (step.is_index) {
      pattern += "[]";
    } else {
      pattern += fmt::format("{}{}", pattern.empty() ? "" : ".", named ? "*" : step.key);
    }
  }
  *at = std::move(value);
}

}  // namespace softreel
