#include "tool/shot/schema_table.h"

#include <fmt/format.h>

#include "core/base/nearest_name.h"

namespace softreel {
namespace {

std::string with_unit(const FieldText& text) {
  return text.unit.empty() ? text.accepted : text.accepted + " (" + text.unit + ")";
}

}  // namespace

Place Place::item(std::size_t index) const {
  return part(fmt::format("[{}]", index));
}

Error value_error(const Place& place, const TomlValue& value, const std::string& reason, const std::string& next) {
  std::string step = next;
  if (step.empty() && place.text != nullptr && !place.text->required && !place.text->default_value.empty())
    step = fmt::format("Correct it, or leave the field out for its default: {}.", place.text->default_value);
  if (step.empty()) step = "Correct it.";
  const std::string accepted = place.text == nullptr ? "the tables and fields of a shot" : with_unit(*place.text);
  return input_error(fmt::format("{}: {} = {} is wrong because {}.\n  Accepted: {}. {}", to_string(value.origin),
                                 place.path.empty() ? "the document" : place.path, to_short_text(value), reason,
                                 accepted, step));
}

Error missing_error(const Place& table, const TomlValue& value, const FieldText& field) {
  const std::string path = table.path.empty() ? field.path : table.path + "." + field.path;
  return input_error(
      fmt::format("{}: {} = (nothing) is wrong because it must be given.\n  Accepted: {}. Add a line {} = ... {}",
                  to_string(value.origin), path, with_unit(field), field.path, "to this table: " + field.sentence));
}

Error unknown_field_error(const Place& table, const TomlEntry& entry, const std::vector<std::string>& known) {
  const std::string path = table.path.empty() ? key_text(entry.key) : table.path + "." + key_text(entry.key);
  const std::string nearest = nearest_name(entry.key, known);
  const std::string next =
      nearest.empty() ? "Remove it, or use one of these." : fmt::format("Did you mean '{}'?", nearest);
  return input_error(fmt::format("{}: {} = {} is wrong because there is no field of this name.\n  Accepted: {}. {}",
                                 to_string(entry.key_origin), path, to_short_text(entry.value),
                                 fmt::format("{}", fmt::join(known, ", ")), next));
}

std::string suggestion(const std::string& unknown, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(unknown, known);
  return nearest.empty() ? "" : fmt::format(" Did you mean '{}'?", nearest);
}

}  // namespace softreel
