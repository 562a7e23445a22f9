// The table of the whole document and of how the shot runs: shot, gravity, golden; what must hold between tables.
#include <algorithm>

#include <fmt/format.h>

#include "core/base/nearest_name.h"
#include "tool/shot/codecs.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

constexpr int kLastFrame = 1000000;
constexpr const char* kDefaultMaterial = "default";

struct FramePair {
  int first = 0, last = 0;
};

/// [first, last] of a shot.
void add_frames(Table<ShotSettings>& table) {
  const Codec<int> frame = whole<int>(-kLastFrame, kLastFrame);
  Field<ShotSettings> field;
  field.text = {"frames",
                "[first, last]",
                "frames",
                "[1, 96]",
                fmt::format("two whole numbers from {} to {}, the second not below the first", -kLastFrame, kLastFrame),
                "First and last frame of the pictures.",
                false,
                false};
  field.read = [frame](const Place& place, const TomlValue& value, ShotSettings& out) {
    const auto* items = value.array();
    if (items == nullptr || items->size() != 2) throw value_error(place, value, "it is not a list of two frames");
    out.first_frame = frame.parse(place.part("[0]"), (*items)[0]);
    out.last_frame = frame.parse(place.part("[1]"), (*items)[1]);
    if (out.first_frame > out.last_frame)
      throw value_error(place, value, "it ends before it begins", "Exchange the two frames.");
  };
  field.write = [](const ShotSettings& in) -> std::optional<TomlValue> {
    return toml_value(
        TomlValue::Array{toml_value(std::int64_t{in.first_frame}), toml_value(std::int64_t{in.last_frame})});
  };
  field.text.default_value = to_text(*field.write(ShotSettings{}));
  table.fields.push_back(std::move(field));
}

const Table<ShotSettings>& settings_table() {
  static const Table<ShotSettings> table = [] {
    using S = ShotSettings;
    Table<S> t;
    t.sentence = "Name, time and kind of the shot.";
    t.add("name", &S::name, file_name(), "", "Files of the output begin with it.", "the file's name without .toml")
        .add("fps", &S::fps, number({0, 100000, true}), "frames/s", "Frames a second.");
    add_frames(t);
    t.add("preroll", &S::preroll, whole<int>(0, kLastFrame), "frames",
          "Simulated before the first frame and not shown, at the frame numbers before it: keys hold their first "
          "values there, and what is active from the first frame on is not active yet.")
        .add("start", &S::start,
             choice<StartState>({{"rest", StartState::Rest}, {"equilibrium", StartState::Equilibrium}}), "",
             "Begin undeformed, or sagged into balance under what acts at the first frame, or the first of preroll: "
             "gravity, pins, pulls and glue.")
        .add("mode", &S::mode,
             choice<SimulationMode>({{"dynamic", SimulationMode::Dynamic}, {"static", SimulationMode::Static}}), "",
             "\"dynamic\" swings and flies; \"static\" is in balance at each frame.")
        .add("independent", &S::independent, toggle(), "",
             "static: each frame starts from rest, so that frames can be computed apart.");
    return t;
  }();
  return table;
}

const Table<Shot>& gravity_table() {
  static const Table<Shot> table = [] {
    Table<Shot> t;
    t.sentence = "Weight.";
    t.add("acceleration", &Shot::gravity, vector_of<Vec3>(kAnyNumber), "m/s^2", "Of everything that falls.");
    return t;
  }();
  return table;
}

Codec<std::vector<int>> frame_list_codec() {
  Codec<std::vector<int>> codec;
  codec.type = "list of whole numbers";
  codec.accepted = "rising frames, at least one";
  codec.parse = [](const Place& place, const TomlValue& value) {
    const auto* items = value.array();
    if (items == nullptr) throw value_error(place, value, "it is " + kind_name(value) + ", not a list");
    if (items->empty()) throw value_error(place, value, "the list is empty");
    std::vector<int> frames;
    for (const TomlValue& item : *items) {
      const Place at = place.item(frames.size());
      frames.push_back(static_cast<int>(parse_whole(at, item, -kLastFrame, kLastFrame)));
      if (frames.size() > 1 && frames.back() <= frames[frames.size() - 2])
        throw value_error(at, item, "it does not come after the frame before it", "Sort the frames, each once.");
    }
    return frames;
  };
  codec.print = [](const std::vector<int>& frames) -> std::optional<TomlValue> {
    if (frames.empty()) return std::nullopt;
    TomlValue::Array items;
    for (const int frame : frames) items.push_back(toml_value(std::int64_t{frame}));
    return toml_value(std::move(items));
  };
  return codec;
}

const Table<GoldenSettings>& golden_table() {
  static const Table<GoldenSettings> table = [] {
    using G = GoldenSettings;
    Table<G> t;
    t.sentence = "Which pictures are compared with stored ones, and how closely.";
    t.add("frames", &G::frames, frame_list_codec(), "frames", "Frames that are compared.", "first, middle and last")
        .add("threshold", &G::threshold, number(kNotNegative), "",
             "Largest FLIP error (0: looks the same, 1: green for blue) that a block of 16 x 16 pixels may have.")
        .add("max_width", &G::max_width, whole<int>(16, 32768), "pixels",
             "A wider picture is compared at this width; the height follows.")
        .add("max_samples", &G::max_samples, whole<int>(1, 1 << 20), "paths a pixel", "More are not taken.");
    return t;
  }();
  return table;
}

/// `schema` and `use` say how the document is read; the shot does not keep them.
void add_document_fields(Table<Shot>& table) {
  Field<Shot> schema;
  const std::string supported = std::to_string(kSchemaVersion);
  schema.text = {"schema",
                 "whole number",
                 "",
                 supported,
                 "1 to " + supported,
                 "Version of the fields that the file was written for.",
                 false,
                 false};
  schema.read = [](const Place& place, const TomlValue& value, Shot&) { parse_whole(place, value, 1, kSchemaVersion); };
  schema.write = [](const Shot&) { return toml_value(std::int64_t{kSchemaVersion}); };
  table.fields.push_back(std::move(schema));
  Field<Shot> use;
  use.text = {"use",
              "list of paths",
              "",
              "none",
              "paths of presets in quotes, relative to the file that says them",
              "Presets that are read first; later ones win over earlier ones, the file's own values over all.",
              false,
              false};
  use.read = [](const Place&, const TomlValue&, Shot&) {};  // resolved before the document is read
  use.write = [](const Shot&) { return std::nullopt; };     // what presets say is written out
  table.fields.push_back(std::move(use));
}

std::vector<std::string> material_names(const Shot& shot) {
  std::vector<std::string> names;
  for (const auto& named : shot.materials) names.push_back(named.first);
  return names;
}

/// The error for a material that the shot does not have.
void check_material(const Shot& shot, const Place& place, const TomlValue* value) {
  if (value == nullptr || shot.materials.count(*value->text()) > 0) return;
  const std::vector<std::string> names = material_names(shot);
  std::string known;
  for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
  const FieldText text{"", "", "", "", known, "", false, false};
  throw value_error({place.path, &text, place.problems}, *value, "there is no material of this name",
                    fmt::format("Add a [material.{}] or use one of these.{}", key_text(*value->text()),
                                suggestion(*value->text(), names)));
}

/// Gives a body without a material the only one there is, or the one named "default".
void choose_material(const Shot& shot, const Place& place, const TomlValue& value, BodySettings& body) {
  if (!body.material.empty()) return;
  if (shot.materials.count(kDefaultMaterial) > 0) {
    body.material = kDefaultMaterial;
  } else if (shot.materials.size() == 1) {
    body.material = shot.materials.begin()->first;
  } else {
    std::string known;
    for (const std::string& name : material_names(shot)) known += (known.empty() ? "" : ", ") + name;
    const FieldText text{"material", "", "", "", known, "one of these materials.", false, false};
    throw missing_error(place, value, text);
  }
}

/// What the error dial chooses is 0: sizes, steps and the tolerance that matters, where the shot does not give them.
void open_for_dial(const TomlValue& value, Shot& shot) {
  if (!shot.dial.is_on()) return;
  const TomlValue& solver = *value.find("solver");
  const auto is_open = [&solver](const char* name) { return solver.find(name) == nullptr; };
  if (is_open("integrator")) shot.solver.integrator = Integrator::Bdf2;
  const bool is_static = shot.settings.mode == SimulationMode::Static;
  if (!is_static && is_open("substeps")) shot.solver.substeps = 0;
  const bool balances = is_static || linearization(shot.solver) == Linearize::Iterated;
  const char* tolerance = balances ? "force_tolerance" : "tolerance";
  if (is_open(tolerance)) (balances ? shot.solver.force_tolerance : shot.solver.tolerance) = 0;
  for (BodySettings& body : shot.bodies) {
    const TomlValue& table = *value.find("body")->find(body.name);
    const auto is_given = [&table](const std::string& name) { return table.find(name) != nullptr; };
    const auto& sizes = alternatives().front().fields;
    if (std::none_of(sizes.begin(), sizes.end(), is_given)) body.tets = 0;
  }
}

void check_shot(const Place& place, const TomlValue& value, Shot& shot) {
  if (shot.bodies.empty()) {
    const FieldText text{
        "body.NAME", "", "", "", "one or more tables [body.NAME] with a mesh", "a shot shows a body.", false, false};
    throw missing_error(place, value, text);
  }
  if (shot.materials.empty()) shot.materials[kDefaultMaterial] = {};
  for (BodySettings& body : shot.bodies) {
    const Place at{"body." + key_text(body.name), nullptr, place.problems};
    const TomlValue& table = *value.find("body")->find(body.name);
    check_material(shot, at.part(".material"), table.find("material"));
    choose_material(shot, at, table, body);
    for (std::size_t i = 0; i < body.regions.size(); ++i)
      check_material(shot, at.part(fmt::format(".region[{}].material", i)),
                     (*table.find("region")->array())[i].find("material"));
  }
  if (shot.camera.focal_length_mm.keys.empty()) shot.camera.focal_length_mm.keys = {{0, 50, Ease::Smooth}};
  check_glues(shot, place, value);
  open_for_dial(value, shot);
}

void add_bodies_and_materials(Table<Shot>& table) {
  table.add_named(
      "body",
      [](Shot& shot, const std::string& name) -> BodySettings& {
        shot.bodies.emplace_back().name = name;
        return shot.bodies.back();
      },
      [](const Shot& shot, const auto& visit) {
        for (const BodySettings& body : shot.bodies) visit(body.name, body);
      },
      body_table());
  table.add_named(
      "material", [](Shot& shot, const std::string& name) -> MaterialSettings& { return shot.materials[name]; },
      [](const Shot& shot, const auto& visit) {
        for (const auto& [name, material] : shot.materials) visit(name, material);
      },
      material_table());
}

}  // namespace

const std::vector<Alternatives>& alternatives() {
  static const std::vector<Alternatives> all{{"body.*", {"tets", "edge", "error", "tetrahedra"}},
                                             {"body.*", {"fit", "scale"}},
                                             {"body.*.region[]", {"material", "stiffness"}},
                                             {"body.*.pin[]", {"keys", "follow"}},
                                             {"body.*.pull[]", {"keys", "follow"}},
                                             {"material.*", {"base_color", "base_color_texture", "vertex_colors"}},
                                             {"material.*", {"roughness", "roughness_texture"}}};
  return all;
}

const TomlValue* find_given(const TomlValue& table, const std::string& name) {
  const TomlValue* found = table.find(name);
  const bool* toggled = found == nullptr ? nullptr : std::get_if<bool>(&found->data);
  return toggled != nullptr && !*toggled ? nullptr : found;
}

void check_alternatives(const Place& place, const TomlValue& value, const std::string& pattern) {
  for (const Alternatives& group : alternatives()) {
    if (group.table != pattern) continue;
    const TomlValue* given = nullptr;
    std::string first;
    for (const std::string& name : group.fields) {
      const TomlValue* found = find_given(value, name);
      if (found != nullptr && given != nullptr) {
        const FieldText text{"", "", "", "", first + " or " + name + ", not both", "", false, false};
        throw value_error({place.path + "." + name, &text, place.problems}, *found,
                          fmt::format("{} is given too ({})", first, to_string(given->origin)),
                          "Remove one of the two.");
      }
      if (found != nullptr) {
        given = found;
        first = name;
      }
    }
  }
}

const Table<Shot>& shot_table() {
  static const Table<Shot> table = [] {
    const auto whole_shot = [](auto& shot) -> auto& {
      return shot;
    };
    Table<Shot> t;
    t.sentence = "A shot.";
    add_document_fields(t);
    t.add_table("shot", &Shot::settings, settings_table()).add_table("gravity", whole_shot, gravity_table());
    add_bodies_and_materials(t);
    t.add_list("glue", &Shot::glues, glue_table());
    t.add_table("solver", whole_shot, solver_table())
        .add_table("camera", &Shot::camera, camera_table())
        .add_list("light", &Shot::lights, light_table())
        .add_table("environment", whole_shot, environment_table())
        .add_optional_table("ground", &Shot::ground, ground_table())
        .add_table("render", &Shot::render, render_table())
        .add_table("output", &Shot::output, output_table())
        .add_table("golden", &Shot::golden, golden_table());
    t.check = check_shot;
    return t;
  }();
  return table;
}

}  // namespace softreel
