// The tables of lights: lamps and suns, and the sky.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "tool/shot/codecs.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

/// What a kind of light is called, and the fields that not all kinds have.
struct KindText {
  LightKind kind;
  std::string name;
  std::string called;
  std::vector<std::string> fields;
};

const std::vector<KindText>& kinds() {
  static const std::vector<KindText> texts{
      {LightKind::Area, "area", "an area light", {"center", "aim", "size", "power", "visible"}},
      {LightKind::Disk, "disk", "a disk", {"center", "aim", "size", "power", "visible"}},
      {LightKind::Sphere, "sphere", "a sphere", {"center", "radius", "power", "visible"}},
      {LightKind::Sun, "sun", "a sun", {"direction", "irradiance", "angle_deg"}}};
  return texts;
}

bool has(const KindText& kind, const std::string& field) {
  return std::find(kind.fields.begin(), kind.fields.end(), field) != kind.fields.end();
}

bool has_some_kind(const std::string& field) {
  return std::any_of(kinds().begin(), kinds().end(), [&](const KindText& kind) { return has(kind, field); });
}

const KindText& text_of(LightKind kind) {
  return *std::find_if(kinds().begin(), kinds().end(), [&](const KindText& text) { return text.kind == kind; });
}

/// At all keys of both; between them the two may still meet, which lights_at finds.
bool aims_at_itself(const LightSettings& light) {
  const auto meet_at = [&](const auto& key) { return light.center.at(key.frame) == light.aim.at(key.frame); };
  return std::any_of(light.center.keys.begin(), light.center.keys.end(), meet_at) ||
         std::any_of(light.aim.keys.begin(), light.aim.keys.end(), meet_at);
}

void check_light(const Place& place, const TomlValue& value, LightSettings& light) {
  const KindText& kind = text_of(light.kind);
  for (const TomlEntry& entry : *value.table()) {
    if (!has_some_kind(entry.key) || has(kind, entry.key)) continue;
    const KindText& owner =
        *std::find_if(kinds().begin(), kinds().end(), [&](const KindText& other) { return has(other, entry.key); });
    throw value_error({place.path + "." + entry.key, place.text, place.problems}, entry.value,
                      kind.called + " has no such field", fmt::format("Remove it, or say type = \"{}\".", owner.name));
  }
  const bool aims = light.kind == LightKind::Area || light.kind == LightKind::Disk;
  if (aims && aims_at_itself(light))
    throw value_error(place, value, "it aims at its own center", "Move center or aim.");
  const auto& directions = light.direction.keys;
  if (light.kind == LightKind::Sun &&
      std::any_of(directions.begin(), directions.end(), [](const auto& key) { return key.value.isZero(0); }))
    throw value_error(place, value, "its direction has no length", "Give the way its light travels.");
}

void add_light_fields(Table<LightSettings>& t) {
  using L = LightSettings;
  std::vector<std::pair<std::string, LightKind>> names;
  for (const KindText& kind : kinds()) names.emplace_back(kind.name, kind.kind);
  t.require("type", &L::kind, choice<LightKind>(names), "",
            "\"area\", \"disk\": a rectangle or ellipse that shines from one side; \"sphere\": a ball; \"sun\": a "
            "distant disk.")
      .add("center", &L::center, keyed(vector_of<Vec3>(in_single(kAnyNumber)), "m"), "m",
           "Lamps: its middle; where keys move it, it has no motion blur.")
      .add("aim", &L::aim, keyed(vector_of<Vec3>(in_single(kAnyNumber)), "m"), "m", "area, disk: the point it faces.")
      .add("size", &L::size, vector_of<Vec2>(in_single(kPositive), "[width, height]"), "m",
           "area, disk: its edges or diameters.")
      .add("radius", &L::radius, number(in_single(kPositive)), "m", "sphere: half its diameter.")
      .add("color", &L::color, keyed(vector_of<Vec3>(in_single(kNotNegative), kColorType), "linear"), "linear",
           "Colour of its light.")
      .add("power", &L::power, keyed(number(in_single(kNotNegative)), "W"), "W",
           "Of a sphere all it emits; area and disk have the radiance power / (4 area) and emit pi / 4 of it.")
      .add("visible", &L::visible, toggle(), "",
           "Lamps: whether the camera sees the lamp itself, which adds its light to what is behind and hides nothing.")
      .add("direction", &L::direction, keyed(vector_of<Vec3>(in_single(kAnyNumber)), ""), "",
           "sun: the way its light travels.")
      .add("irradiance", &L::irradiance, keyed(number(in_single(kNotNegative)), "W/m^2"), "W/m^2",
           "sun: on a surface that faces it.")
      .add("angle_deg", &L::angle_deg, number({0, 90, false}), "degrees",
           "sun: diameter; small ones cast hard shadows.");
}

}  // namespace

const Table<LightSettings>& light_table() {
  static const Table<LightSettings> table = [] {
    Table<LightSettings> t;
    t.sentence = "A lamp or a sun.";
    add_light_fields(t);
    for (Field<LightSettings>& field : t.fields) {
      const std::string name = field.text.path;
      if (!has_some_kind(name)) continue;
      field.write = [name, write = field.write](const LightSettings& light) {
        return has(text_of(light.kind), name) ? write(light) : std::nullopt;
      };
    }
    t.check = check_light;
    return t;
  }();
  return table;
}

const Table<SkySettings>& sky_table() {
  static const Table<SkySettings> table = [] {
    using S = SkySettings;
    Table<S> t;
    t.sentence =
        "Daylight; if this table is there, instead of gradient and picture (Preetham, Shirley and Smits, 1999); 1 is "
        "10 kcd/m^2, so that a sky "
        "is "
        "about 0.5.";
    t.add("turbidity", &S::turbidity, keyed(number({2, 10, false}), ""), "", "Haze: 2 very clear, 3 clear, 6 hazy.")
        .add("elevation_deg", &S::elevation_deg, keyed(number({0, 90, false}), "degrees"), "degrees",
             "Of the sun above the horizon.")
        .add("azimuth_deg", &S::azimuth_deg, keyed(number(in_single(kAnyNumber)), "degrees"), "degrees",
             "Of the sun about the vertical; 0: in front, 90: on the right.")
        .add("ground_albedo", &S::ground_albedo, number(kShare), "", "Share that what is below the horizon sends back.")
        .add("sun", &S::sun, toggle(), "", "Whether the sun itself shines.")
        .add("sun_angle_deg", &S::sun_angle_deg, number({0, 90, false}), "degrees",
             "Diameter of the sun; larger ones cast softer shadows.");
    return t;
  }();
  return table;
}

}  // namespace softreel
