// The tables of the picture: camera, lights, environment, ground, render, output.
#include <fmt/format.h>

#include "tool/shot/codecs.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

const std::string kColorType = "[r, g, b]";

void check_camera(const Place& place, const TomlValue& value, CameraSettings& camera) {
  if (camera.mode != CameraMode::Place) return;
  for (const auto* field : {"position", "target"})
    if (value.find(field) == nullptr)
      throw value_error(place, value, fmt::format("mode = \"place\" needs a {}", field),
                        fmt::format("Add {} = [x, y, z] in m, or use mode = \"frame\".", field));
}

/// Fields of [[light]] that only one kind of light has.
const std::vector<std::string>& fields_of(LightKind kind) {
  static const std::vector<std::string> area{"center", "aim", "size", "power", "visible"};
  static const std::vector<std::string> sun{"direction", "irradiance", "angle_deg"};
  return kind == LightKind::Area ? area : sun;
}

void check_light(const Place& place, const TomlValue& value, LightSettings& light) {
  const LightKind other = light.kind == LightKind::Area ? LightKind::Sun : LightKind::Area;
  for (const std::string& name : fields_of(other))
    if (const TomlValue* given = value.find(name))
      throw value_error(
          {place.path + "." + name, place.text, place.problems}, *given,
          light.kind == LightKind::Area ? "an area light has no such field" : "a sun has no such field",
          light.kind == LightKind::Area ? "Remove it, or say type = \"sun\"." : "Remove it, or say type = \"area\".");
  if (light.kind == LightKind::Area && light.center == light.aim)
    throw value_error(place, value, "it aims at its own center", "Move center or aim.");
  if (light.kind == LightKind::Sun && light.direction.isZero(0))
    throw value_error(place, value, "its direction has no length", "Give the way its light travels.");
}

AreaLight resolved_area(const LightSettings& light) {
  const Vec3 normal = (light.aim - light.center).normalized();
  // A lamp that looks straight up or down lies along x; any other stands upright.
  const Vec3 across = std::abs(normal.y()) > 0.999999 ? Vec3(Vec3::UnitX()) : Vec3::UnitY().cross(normal).normalized();
  const Vec3 upward = normal.cross(across);
  AreaLight area;
  area.center = light.center.cast<float>();
  area.u = (0.5 * light.size.x() * across).cast<float>();
  area.v = (0.5 * light.size.y() * upward).cast<float>();
  area.radiance = (light.color * (light.power / (4 * light.size.x() * light.size.y()))).cast<float>();
  area.visible = light.visible;
  return area;
}

SunLight resolved_sun(const LightSettings& light) {
  SunLight sun;
  sun.direction = light.direction.normalized().cast<float>();
  sun.irradiance = (light.color * light.irradiance).cast<float>();
  sun.angular_diameter = static_cast<float>(to_radians(light.angle_deg));
  return sun;
}

}  // namespace

void resolve_lights(Shot& shot) {
  shot.area_lights.clear();
  shot.suns.clear();
  for (const LightSettings& light : shot.lights) {
    if (light.kind == LightKind::Area) shot.area_lights.push_back(resolved_area(light));
    if (light.kind == LightKind::Sun) shot.suns.push_back(resolved_sun(light));
  }
}

const Table<CameraSettings>& camera_table() {
  static const Table<CameraSettings> table = [] {
    using C = CameraSettings;
    Table<C> t;
    t.sentence = "Where the picture is taken from.";
    t.add("mode", &C::mode, choice<CameraMode>({{"frame", CameraMode::Frame}, {"place", CameraMode::Place}}), "",
          "\"frame\" shows all bodies as they rest; \"place\" takes position and target.")
        .add("azimuth_deg", &C::azimuth_deg, number(kAnyNumber), "degrees",
             "frame: turns the camera about the vertical; 0 is the front.")
        .add("elevation_deg", &C::elevation_deg, number({-90, 90, false}), "degrees", "frame: lifts the camera.")
        .add("margin", &C::margin, number(kPositive), "", "frame: size of the picture over that of the bodies.")
        .add("shift", &C::shift, vector_of<Vec3>(kAnyNumber), "heights of the bodies",
             "frame: moves what is looked at.")
        .add("position", &C::position, keyed(vector_of<Vec3>(kAnyNumber), "m"), "m", "place: where the camera stands.",
             "none; must be given with mode = \"place\"")
        .add("target", &C::target, keyed(vector_of<Vec3>(kAnyNumber), "m"), "m", "place: what it looks at.",
             "none; must be given with mode = \"place\"")
        .add("focal_length_mm", &C::focal_length_mm, keyed(number(kPositive), "mm"), "mm",
             "The lens: 24 is wide, 50 normal, 100 narrow.", "50")
        .add("sensor_width_mm", &C::sensor_width_mm, number(kPositive), "mm", "Width of the sensor.")
        .add("f_number", &C::f_number, number(kNotNegative), "", "Aperture, such as 2.8; 0: everything is sharp.")
        .add("focus_distance", &C::focus_distance, keyed(number(kPositive), "m"), "m", "Where it is sharp.",
             "at the target");
    t.check = check_camera;
    return t;
  }();
  return table;
}

const Table<LightSettings>& light_table() {
  static const Table<LightSettings> table = [] {
    using L = LightSettings;
    Table<L> t;
    t.sentence = "A lamp or a sun.";
    t.require("type", &L::kind, choice<LightKind>({{"area", LightKind::Area}, {"sun", LightKind::Sun}}), "",
              "\"area\": a rectangle that shines from one side; \"sun\": a distant disk.")
        .add("center", &L::center, vector_of<Vec3>(kAnyNumber), "m", "area: its middle.")
        .add("aim", &L::aim, vector_of<Vec3>(kAnyNumber), "m", "area: the point it faces.")
        .add("size", &L::size, vector_of<Vec2>(kPositive, "[width, height]"), "m", "area: its edges.")
        .add("color", &L::color, vector_of<Vec3>(kNotNegative, kColorType), "linear", "Colour of its light.")
        .add("power", &L::power, number(kNotNegative), "W",
             "area: of the whole lamp; its radiance is power / (4 area).")
        .add("visible", &L::visible, toggle(), "", "area: whether the camera sees the lamp itself.")
        .add("direction", &L::direction, vector_of<Vec3>(kAnyNumber), "", "sun: the way its light travels.")
        .add("irradiance", &L::irradiance, number(kNotNegative), "W/m^2", "sun: on a surface that faces it.")
        .add("angle_deg", &L::angle_deg, number({0, 90, false}), "degrees",
             "sun: diameter; small ones cast hard shadows.");
    for (const LightKind kind : {LightKind::Area, LightKind::Sun})
      for (const std::string& name : fields_of(kind))
        for (Field<L>& field : t.fields)
          if (field.text.path == name)
            field.write = [kind, write = field.write](const L& light) {
              return light.kind == kind ? write(light) : std::nullopt;
            };
    t.check = check_light;
    return t;
  }();
  return table;
}

const Table<Shot>& environment_table() {
  static const Table<Shot> table = [] {
    Table<Shot> t;
    t.sentence = "What surrounds the scene: a vertical gradient, or a picture.";
    const auto color = [&t](const char* name, Vec3f Environment::*member, const char* sentence) {
      t.add(
          name, [member](auto& s) -> auto& { return s.environment.*member; },
          vector_of<Vec3f>(kNotNegative, kColorType), "linear", sentence);
    };
    color("zenith", &Environment::zenith, "Radiance straight up.");
    color("horizon", &Environment::horizon, "Radiance at the horizon.");
    color("nadir", &Environment::nadir, "Radiance straight down.");
    t.add("image", &Shot::environment_image, file_path(), "",
          "A latitude-longitude picture (EXR, HDR, PNG, JPEG) instead of the gradient.", "none: the gradient")
        .add(
            "strength", [](auto& s) -> auto& { return s.environment.strength; }, single(kNotNegative), "",
            "Factor on gradient or picture.")
        .add(
            "rotation_deg", [](auto& s) -> auto& { return s.environment.rotation; }, degrees_single(kAnyNumber),
            "degrees", "Turns the picture about the vertical.");
    t.check = [](const Place&, const TomlValue& value, Shot& shot) {
      const TomlValue* image = value.find("image");
      shot.environment_origin = image != nullptr ? image->origin : value.origin;
    };
    return t;
  }();
  return table;
}

const Table<Ground>& ground_table() {
  static const Table<Ground> table = [] {
    using G = Ground;
    Table<G> t;
    t.sentence = "What the bodies stand on in the picture; there is a ground if this table is there.";
    t.add("style", &G::style, choice<GroundStyle>({{"plane", GroundStyle::Plane}, {"sweep", GroundStyle::Sweep}}), "",
          "\"plane\": a square; \"sweep\": bends up into a wall behind the bodies.")
        .add("height", &G::height, single(kAnyNumber), "m", "Its y.")
        .add("size", &G::size, single(kPositive), "m", "Edge of the square.")
        .add("sweep", &G::sweep, single(kPositive), "m", "sweep: from the origin to where the wall begins to rise.")
        .add(
            "color", [](auto& g) -> auto& { return g.appearance.base_color; }, vector_of<Vec3f>(kShare, kColorType),
            "linear", "Share of the light that comes back.")
        .add(
            "roughness", [](auto& g) -> auto& { return g.appearance.roughness; }, single(kShare), "",
            "0 mirrors, 1 is matte.")
        .add(
            "specular", [](auto& g) -> auto& { return g.appearance.specular; }, single(kShare), "",
            "Strength of its reflections.")
        .add("checker", &G::checker, single(kNotNegative), "m", "Edge of the squares of a two-tone pattern; 0: none.")
        .add("checker_color", &G::checker_color, vector_of<Vec3f>(kShare, kColorType), "linear",
             "Colour of every other square.");
    return t;
  }();
  return table;
}

namespace {

/// A list of names of channels.
Codec<ChannelSet> channels_codec() {
  static const std::vector<std::pair<std::string, PictureChannel>> known{{"albedo", PictureChannel::Albedo},
                                                                         {"normal", PictureChannel::Normal},
                                                                         {"depth", PictureChannel::Depth},
                                                                         {"position", PictureChannel::Position},
                                                                         {"motion", PictureChannel::Motion},
                                                                         {"object_id", PictureChannel::ObjectId},
                                                                         {"material_id", PictureChannel::MaterialId},
                                                                         {"strain", PictureChannel::Strain},
                                                                         {"samples", PictureChannel::Samples}};
  static const Codec<PictureChannel> one = choice<PictureChannel>(known);
  Codec<ChannelSet> codec;
  codec.type = "list of texts";
  codec.accepted = "any of " + one.accepted;
  codec.parse = [](const Place& place, const TomlValue& value) {
    const TomlValue::Array* items = value.array();
    if (items == nullptr) throw value_error(place, value, "it is " + kind_name(value) + ", not a list");
    ChannelSet set;
    for (std::size_t i = 0; i < items->size(); ++i) set.add(one.parse(place.item(i), (*items)[i]));
    return set;
  };
  codec.print = [](const ChannelSet& set) -> std::optional<TomlValue> {
    if (set.bits == 0) return std::nullopt;
    TomlValue::Array items;
    for (const auto& [name, channel] : known)
      if (set.has(channel)) items.push_back(toml_value(name));
    return toml_value(std::move(items));
  };
  return codec;
}

}  // namespace

const Table<RenderSettings>& render_table() {
  static const Table<RenderSettings> table = [] {
    using R = RenderSettings;
    Table<R> t;
    t.sentence = "How the picture is computed.";
    t.add(
         "width", [](auto& r) -> auto& { return r.params.width; }, whole<int>(1, 32768), "pixels", "Of the picture.")
        .add(
            "height", [](auto& r) -> auto& { return r.params.height; }, whole<int>(1, 32768), "pixels",
            "Of the picture.")
        .add(
            "samples", [](auto& r) -> auto& { return r.params.samples; }, whole<int>(1, 1 << 20), "paths a pixel",
            "Four times as many halve the noise and take four times as long.")
        .add(
            "max_bounces", [](auto& r) -> auto& { return r.params.max_bounces; }, whole<int>(0, 1024), "",
            "How often a path is scattered at most.")
        .add(
            "clamp", [](auto& r) -> auto& { return r.params.clamp; }, single(kNotNegative), "radiance",
            "Most that one indirect sample may add: removes bright specks, darkens a little; 0: off.")
        .add(
            "caustic_roughness", [](auto& r) -> auto& { return r.params.caustic_roughness; }, single(kShare), "",
            "Least roughness of what matt surfaces see: blurs caustics that would be bright specks; 0: off.")
        .add("shutter", &R::shutter, number(kShare), "frames",
             "How long the shutter is open, up to the frame; 0: no motion blur.")
        .add("blur_segments", &R::blur_segments, whole<int>(1, 64), "",
             "Straight pieces of each point's path while the shutter is open.")
        .add(
            "auxiliary", [](auto& r) -> auto& { return r.params.auxiliary; }, toggle(), "",
            "Writes albedo, normal and depth into the EXR too.")
        .add(
            "channels", [](auto& r) -> auto& { return r.params.channels; }, channels_codec(), "",
            "What the EXR holds beside the colour; with \"motion\" each frame asks for the next one.", "none");
    add_heat_fields(t);
    return t;
  }();
  return table;
}

const Table<OutputSettings>& output_table() {
  static const Table<OutputSettings> table = [] {
    using O = OutputSettings;
    Table<O> t;
    t.sentence = "What is written.";
    t.add("directory", &O::directory, text(), "", "Where to, relative to the working directory.")
        .add(
            "view", &O::view,
            choice<ViewTransform>({{"standard", ViewTransform::Standard},
                                   {"filmic", ViewTransform::Filmic},
                                   {"aces-fit", ViewTransform::AcesFit},
                                   {"raw", ViewTransform::Raw}}),
            "",
            "How light becomes colour in the PNG. \"standard\": sRGB, clipped; \"filmic\": the same below 0.76, bright "
            "colours roll off (Khronos PBR Neutral); \"aces-fit\": S. Hill's fit of ACES 1.0, more contrast; \"raw\": "
            "no curve at all.")
        .add("exposure", &O::exposure, number({-64, 64, false}), "stops", "Each stop doubles the brightness.")
        .add("png", &O::png, toggle(), "", "Writes a PNG of each frame.")
        .add("exr", &O::exr, toggle(), "", "Writes a scene-linear EXR of each frame.")
        .add("burn_in", &O::burn_in, toggle(), "", "Writes shot and frame number into the PNG, and so into the movie.")
        .add("contact_sheet", &O::contact_sheet, toggle(), "",
             "Writes SHOT.sheet.png with a small picture of up to 16 frames, too.")
        .add("movie", &O::movie, toggle(), "", "Joins the frames to a movie, where ffmpeg is installed.")
        .add("cache_limit", &O::cache_limit_gb, number({0, 1e9, false}), "GB",
             "Stored results beyond it are removed, those used longest ago first; 0: no limit.");
    return t;
  }();
  return table;
}

}  // namespace softreel
