// The table of glue between bodies.
#include <algorithm>

#include <fmt/format.h>

#include "tool/shot/codecs.h"
#include "tool/shot/schema_tables.h"
#include "tool/shot/shot_select.h"

namespace softreel {
namespace {

/// Beyond, numbers hold nothing else beside it.
constexpr Range kGlueStiffness{0, 1e15, false};

/// ["NAME", "NAME"]
Codec<std::vector<std::string>> body_pair_codec() {
  Codec<std::vector<std::string>> codec;
  codec.type = "[name, name]";
  codec.accepted = "the names of two bodies";
  codec.parse = [](const Place& place, const TomlValue& value) {
    const auto* items = value.array();
    if (items == nullptr) throw value_error(place, value, "it is " + kind_name(value) + ", not a list of two names");
    if (items->size() != 2) throw value_error(place, value, fmt::format("the list has {} names", items->size()));
    std::vector<std::string> names;
    for (const TomlValue& item : *items) names.push_back(text().parse(place.item(names.size()), item));
    return names;
  };
  codec.print = [](const std::vector<std::string>& names) -> std::optional<TomlValue> {
    TomlValue::Array items;
    for (const std::string& name : names) items.push_back(toml_value(name));
    return toml_value(std::move(items));
  };
  return codec;
}

/// A value of the shot that does not go with what glue is.
Error glue_error(const Place& place, const TomlValue& value, const std::string& accepted, const std::string& reason,
                 const std::string& next) {
  const FieldText text{"", "", "", "", accepted, "", false, false};
  return value_error({place.path, &text, place.problems}, value, reason, next);
}

void check_bodies(const Shot& shot, const GlueSettings& glue, const Place& place, const TomlValue& value) {
  std::vector<std::string> names;
  std::string known;
  for (const BodySettings& body : shot.bodies) {
    names.push_back(body.name);
    known += (known.empty() ? "" : ", ") + body.name;
  }
  const TomlValue& given = *value.find("bodies");
  for (std::size_t k = 0; k < 2; ++k)
    if (std::find(names.begin(), names.end(), glue.bodies[k]) == names.end())
      throw glue_error(place.item(k), (*given.array())[k], known, "there is no body of this name",
                       fmt::format("Use one of these.{}", suggestion(glue.bodies[k], names)));
  if (glue.bodies[0] == glue.bodies[1])
    throw glue_error(place, given, "the names of two different bodies", "a body cannot be glued to itself",
                     "Name another body.");
}

const BodySettings& find_body(const Shot& shot, const std::string& name) {
  return *std::find_if(shot.bodies.begin(), shot.bodies.end(),
                       [&name](const BodySettings& body) { return body.name == name; });
}

/// Glued bodies are one system, whose elements all turn by one method.
void check_rotations(const Shot& shot, const GlueSettings& glue, const Place& place, const TomlValue& value) {
  const BodySettings &first = find_body(shot, glue.bodies[0]), &second = find_body(shot, glue.bodies[1]);
  if (solver_of(shot, first).rotation == solver_of(shot, second).rotation) return;
  throw glue_error(
      place, *value.find("bodies"), "two bodies of one rotation method",
      fmt::format("body \"{}\" and body \"{}\" have different methods of rotation", first.name, second.name),
      "Give both the same rotation.");
}

void check_glue(const Shot& shot, const GlueSettings& glue, const Place& place, const TomlValue& value) {
  const Place bodies = place.part(".bodies");
  check_bodies(shot, glue, bodies, value);
  check_rotations(shot, glue, bodies, value);
  if (shot.dial.is_on())
    throw glue_error(bodies, *value.find("bodies"), "a shot with glue, or solver.error",
                     "solver.error chooses the mesh of each body by runs of it alone, and glued bodies move together",
                     "Leave solver.error out, and give the bodies tets.");
  const bool independent = shot.settings.mode == SimulationMode::Static && shot.settings.independent;
  if (glue.close > 0 && independent)
    throw glue_error(place.part(".close"), *value.find("close"), "close, or shot.independent",
                     "frames that know of no other (shot.independent) close nothing from frame to frame",
                     "Leave one of the two out.");
}

}  // namespace

const Table<GlueSettings>& glue_table() {
  static const Table<GlueSettings> table = [] {
    using G = GlueSettings;
    Table<G> t;
    t.sentence = "Holds the surfaces of two bodies together; forces act on both.";
    t.require("bodies", &G::bodies, body_pair_codec(), "",
              "Two bodies; points of the first stick to the second. Of two, name the smaller or finer one first.")
        .require("distance", &G::distance, number(kPositive), "m",
                 "Points that are no farther from the second body's surface when the glue starts stick.")
        .add("select", &G::select, selection_codec(), "", "Which points of the first body may stick.",
             "the whole surface")
        .add("stiffness", &G::stiffness, keyed(number(kGlueStiffness), "N/m"), "N/m",
             "Of all bonds together; 0 lets go.", "firm: as a hundredth of a tetrahedron of the softer body")
        .add("close", &G::close, number(kNotNegative), "frames",
             "In so many frames gaps are closed; 0: points keep the distance that they had.")
        .add("max_force", &G::max_force, number(kNotNegative), "N", "Of all bonds together; 0: no limit.")
        .add("active", &G::active, frame_ranges_codec(), "frames",
             "When it holds, both frames included; each time it starts, it binds what is near then.", "always");
    return t;
  }();
  return table;
}

void check_glues(const Shot& shot, const Place& place, const TomlValue& value) {
  for (std::size_t i = 0; i < shot.glues.size(); ++i)
    check_glue(shot, shot.glues[i], {fmt::format("glue[{}]", i), nullptr, place.problems},
               (*value.find("glue")->array())[i]);
}

}  // namespace softreel
