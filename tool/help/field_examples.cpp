#include "tool/help/field_examples.h"

#include <map>
#include <string_view>

#include "tool/shot/toml_tree.h"

namespace softreel {
namespace {

/// Fields whose default is nothing, or says nothing: by the end of their paths, longer ones first.
const std::map<std::string, std::string>& own_examples() {
  static const std::map<std::string, std::string> all{
      {"use", "[\"materials/rubber.toml\"]"},
      {"shot.name", "\"take_2\""},
      {".mesh", "\"bunny.ply\""},
      {".tetrahedra", "\"bunny.msh\""},
      {".fit", "1.2"},
      {".edge", "0.03"},
      {".thickness", "0.02"},
      {".crease_deg", "40"},
      {"body.*.error", "\"0.3%\""},
      {"solver.error", "\"1%\""},
      {"body.*.material", "\"rubber\""},
      {"region[].material", "\"rubber\""},
      {"region[].stiffness", "0.1"},
      {".select", "{ box = { min = [0, 0, 0], max = [1, 0.05, 1] }, unit = \"box\" }"},
      {"select.box.min", "[0, 0, 0]"},
      {"select.box.max", "[1, 0.05, 1]"},
      {"select.sphere.radius", "0.2"},
      {"select.group", "\"feet\""},
      {"pull[].stiffness", "8000"},
      {"pin[].keys", "[{ frame = 1 }, { frame = 24, translate = [0, 0.3, 0] }]"},
      {"pull[].keys", "[{ frame = 1 }, { frame = 24, translate = [0, 0.3, 0] }]"},
      {".active", "[1, 44]"},
      {"follow.mesh", "\"skin\""},
      {"follow.file", "\"rig.glb\""},
      {"glue[].bodies", "[\"hat\", \"head\"]"},
      {".follow", "{ file = \"rig.glb\", node = \"jaw\" }"},
      {".weights", "{ file = \"goal.txt\" }"},
      {"_texture", "\"textures/skin.png\""},
      {"environment.image", "\"studio.exr\""},
      {"camera.position", "[0, 1, 4]"},
      {"camera.target", "[0, 0.5, 0]"},
      {"camera.focus_distance", "3.5"},
      {"render.heat_range", "[0, 0.2]"},
      {"render.channels", "[\"depth\", \"motion\"]"},
      {"solver.newmark_beta", "0.36"},
      {"golden.frames", "[1, 48, 96]"},
  };
  return all;
}

/// A value of a type that nothing more is known of.
std::string example_of_type(const FieldText& field) {
  const std::string& type = field.type;
  const std::size_t open = field.accepted.find('"');
  if (type.starts_with("text") && open != std::string::npos)
    return field.accepted.substr(open, field.accepted.find('"', open + 1) - open + 1);
  if (type.starts_with("text")) return "\"name\"";
  if (type.starts_with("path")) return "\"file.txt\"";
  if (type.starts_with("true")) return "true";
  if (type.starts_with("[x, y, z]") || type.starts_with("[r, g, b]")) return "[0, 1, 0]";
  if (type.starts_with("[")) return "[0, 1]";
  return "1";
}

}  // namespace

std::string field_example(const FieldText& field) {
  if (field.is_table) return {};
  const std::string* longest = nullptr;
  std::size_t length = 0;
  for (const auto& [end, example] : own_examples()) {
    if (end.size() <= length || !field.path.ends_with(end)) continue;
    longest = &example;
    length = end.size();
  }
  if (longest != nullptr) return *longest;
  constexpr std::string_view kKeyValue = "[].value";  // what the field says without keys
  if (field.path.ends_with(kKeyValue))
    if (const FieldText* keyed = find_field(field.path.substr(0, field.path.size() - kKeyValue.size())))
      return field_example(*keyed);
  const bool is_value = !field.default_value.empty() && parse_toml_value(field.default_value, {}).has_value();
  return is_value ? field.default_value : example_of_type(field);
}

}  // namespace softreel
