// What can stand left and right of the equals sign of --set.
#include "core/base/error.h"
#include "tool/help/completion.h"
#include "tool/help/field_places.h"
#include "tool/shot/schema.h"
#include "tool/shot/shot_layers.h"

namespace softreel {
namespace {

/// The document of a shot; empty if there is none or it cannot be read: who asks is in the middle of typing.
TomlValue document_of(const std::string& shot) {
  TomlValue none = toml_value(TomlValue::Table{});
  if (shot.empty()) return none;
  try {
    return load_layers(shot, {});
  } catch (const Error&) {
    return none;
  }
}

}  // namespace

std::vector<std::string> settable_fields(const std::string& shot) {
  const TomlValue document = document_of(shot);
  std::vector<std::string> paths;
  for (const FieldText& text : field_texts())
    if (!text.is_table)
      for (FieldPlace& place : field_places(text.path, document)) paths.push_back(std::move(place.path));
  return paths;
}

std::vector<std::string> field_values(const std::string& field, const std::string& shot) {
  const FieldText* text = find_field(field);
  if (text == nullptr) return {};
  if (text->type == "true or false") return {"true", "false"};
  std::vector<std::string> values;
  if (text->path == "body.*.material" || text->path == "body.*.region[].material") {
    const TomlValue document = document_of(shot);
    const TomlValue* materials = document.find("material");
    if (materials != nullptr && materials->table() != nullptr)
      for (const TomlEntry& entry : *materials->table()) values.push_back(entry.key);
    return values;
  }
  // Choices are described as "a", "b" or "c".
  for (std::size_t open = text->accepted.find('"'); open != std::string::npos;) {
    const std::size_t close = text->accepted.find('"', open + 1);
    if (close == std::string::npos) break;
    values.push_back(text->accepted.substr(open + 1, close - open - 1));
    open = text->accepted.find('"', close + 1);
  }
  return text->type == "text" ? values : std::vector<std::string>();
}

}  // namespace softreel
