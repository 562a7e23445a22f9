// The tables of the picture: camera, environment, ground, render, output.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tool/shot/codecs.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

/// A position or target alone says that the camera is placed.
void check_camera(const Place& place, const TomlValue& value, CameraSettings& camera) {
  if (value.find("mode") == nullptr && (value.find("position") != nullptr || value.find("target") != nullptr))
    camera.mode = CameraMode::Place;
  camera.origin = value.origin;
  if (camera.mode != CameraMode::Place) return;
  for (const auto* field : {"position", "target"})
    if (value.find(field) == nullptr)
      throw value_error(place, value, fmt::format("a placed camera needs a {}", field),
                        fmt::format("Add {} = [x, y, z] in m, or use mode = \"frame\".", field));
}

void note_environment_origin(const Place&, const TomlValue& value, Shot& shot) {
  const TomlValue* image = value.find("image");
  shot.environment_origin = image != nullptr ? image->origin : value.origin;
}

constexpr int kMaxSide = 32768;

/// Pixels of the picture, of crop and overscan.
void check_render(const Place& place, const TomlValue& value, RenderSettings& render) {
  const auto fail = [&](const char* name, const std::string& reason, const char* accepted, const char* next) {
    const FieldText text{"", "", "", "", accepted, "", false, false};
    const TomlValue* given = value.find(name);
    throw value_error({place.path + "." + name, &text, place.problems}, given != nullptr ? *given : value, reason,
                      next);
  };
  RenderParams& params = render.params;
  const double width = std::round(render.scale * render.width), height = std::round(render.scale * render.height);
  if (std::min(width, height) < 1 || std::max(width, height) > kMaxSide)
    fail("scale", fmt::format("the picture would have {} x {} pixels", width, height),
         fmt::format("what gives 1 to {} pixels a side", kMaxSide).c_str(),
         "Scale it less, or change render.width and render.height.");
  params.width = static_cast<int>(width);
  params.height = static_cast<int>(height);
  if (params.min_samples % 8 != 0)
    fail("min_samples", "samples are judged in batches of 8", "a multiple of 8, at least 16", "Round it up.");
  if (render.curve.opening + render.curve.closing > 1)
    fail(value.find("shutter_closing") != nullptr ? "shutter_closing" : "shutter_opening",
         "the shutter would close before it is open", "shutter_opening and shutter_closing at most 1 together",
         "Make one of the two shorter.");
  params.window = window_of(render);
  if (params.window == PixelWindow{}) return;
  RenderSettings cropped = render;
  cropped.overscan = 0;
  const PixelWindow crop = window_of(cropped);
  if (crop != PixelWindow{} && (crop.width() < 1 || crop.height() < 1))
    fail("crop", "no pixel is left", "[left, top, right, bottom], left below right and top below bottom",
         "Give the larger numbers last.");
  if (std::max(params.window.width(), params.window.height()) > kMaxSide)
    fail("overscan",
         fmt::format("the picture would have {} x {} pixels", params.window.width(), params.window.height()),
         fmt::format("what gives at most {} pixels a side", kMaxSide).c_str(), "Make it less.");
}

}  // namespace

const Table<CameraSettings>& camera_table() {
  static const Table<CameraSettings> table = [] {
    using C = CameraSettings;
    Table<C> t;
    t.sentence = "Where the picture is taken from.";
    t.add("mode", &C::mode, choice<CameraMode>({{"frame", CameraMode::Frame}, {"place", CameraMode::Place}}), "",
          "\"frame\" shows all bodies as they rest; \"place\" takes position and target.",
          "\"place\" where position and target are given, else \"frame\"")
        .add("azimuth_deg", &C::azimuth_deg, number(in_single(kAnyNumber)), "degrees",
             "frame: turns the camera about the vertical; 0 is the front.")
        .add("elevation_deg", &C::elevation_deg, number({-90, 90, false}), "degrees", "frame: lifts the camera.")
        .add("margin", &C::margin, number(in_single(kPositive)), "",
             "frame: size of the picture over that of the box around the bodies.")
        .add("shift", &C::shift, vector_of<Vec3>(in_single(kAnyNumber)), "heights of the bodies",
             "frame: moves what is looked at.")
        .add("position", &C::position, keyed(vector_of<Vec3>(in_single(kAnyNumber)), "m"), "m",
             "place: where the camera stands.", "none; must be given with mode = \"place\"")
        .add("target", &C::target, keyed(vector_of<Vec3>(in_single(kAnyNumber)), "m"), "m", "place: what it looks at.",
             "none; must be given with mode = \"place\"")
        .add("focal_length_mm", &C::focal_length_mm, keyed(number(in_single(kPositive)), "mm"), "mm",
             "The lens: 24 is wide, 50 normal, 100 narrow.", "50")
        .add("sensor_width_mm", &C::sensor_width_mm, number(in_single(kPositive)), "mm", "Width of the sensor.")
        .add("f_number", &C::f_number, number(in_single(kNotNegative)), "",
             "Aperture, such as 2.8; 0: everything is sharp.")
        .add("focus_distance", &C::focus_distance, keyed(number(in_single(kPositive)), "m"), "m", "Where it is sharp.",
             "at the target");
    t.check = check_camera;
    return t;
  }();
  return table;
}

const Table<Shot>& environment_table() {
  static const Table<Shot> table = [] {
    Table<Shot> t;
    t.sentence = "What surrounds the scene: a vertical gradient, a picture, or a sky.";
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
        .add("strength", &Shot::environment_strength, keyed(widened(single(kNotNegative)), ""), "",
             "Factor on gradient, picture or sky.")
        .add("rotation_deg", &Shot::environment_rotation_deg, keyed(number(in_single(kAnyNumber)), "degrees"),
             "degrees", "Turns the picture about the vertical.")
        .add_optional_table("sky", &Shot::sky, sky_table());
    t.check = note_environment_origin;
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
             "Colour of every other square.")
        .add("shadow_catcher", &G::shadow_catcher, toggle(), "",
             "The camera sees the shadow on it, as one grey alpha (PNG, EXR), and no surroundings. Glass casts an "
             "opaque shadow; light of bodies that shine counts for none.");
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
    t.add("width", &R::width, whole<int>(1, kMaxSide), "pixels", "Of the picture.")
        .add("height", &R::height, whole<int>(1, kMaxSide), "pixels", "Of the picture.")
        .add("scale", &R::scale, number(kPositive), "",
             "Of both: 0.5 makes the same picture with half the width and height.")
        .add(
            "samples", [](auto& r) -> auto& { return r.params.samples; }, whole<int>(1, 1 << 20), "paths a pixel",
            "Four times as many halve the noise and take four times as long. With noise or time_limit: the most.")
        .add(
            "noise", [](auto& r) -> auto& { return r.params.noise; }, single(kShare), "of white",
            "Each pixel stops when its error on the screen is this small, such as 0.01; 0: all get all samples.")
        .add(
            "min_samples", [](auto& r) -> auto& { return r.params.min_samples; }, whole<int>(16, 1 << 20),
            "paths a pixel", "noise: what every pixel gets, a multiple of 8.")
        .add(
            "time_limit", [](auto& r) -> auto& { return r.params.time_limit; }, number(kNotNegative), "s",
            "A frame takes whole passes until then; the picture depends on the machine. 0: no limit.")
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
             "How long the shutter is open, up to the frame, for the camera from its last cut on; 0: no motion blur.")
        .add("blur_segments", &R::blur_segments, whole<int>(1, 64), "",
             "Straight pieces of each point's path, and the camera's, while the shutter is open.")
        .add(
            "shutter_opening", [](auto& r) -> auto& { return r.curve.opening; }, single(kShare), "of shutter",
            "How long it takes to open: 0 at once; 0.5, with shutter_closing, gives blur that fades at both ends.")
        .add(
            "shutter_closing", [](auto& r) -> auto& { return r.curve.closing; }, single(kShare), "of shutter",
            "How long it takes to close.")
        .add("crop", &R::crop, vector_of<Vec4>(kShare, "[left, top, right, bottom]"), "of the picture",
             "Computes this part only, with the same pixels; with noise its edges may get other numbers of samples.")
        .add("overscan", &R::overscan, number(kShare), "of the picture", "Adds this much of the view at each side.")
        .add(
            "auxiliary", [](auto& r) -> auto& { return r.params.auxiliary; }, toggle(), "",
            "Writes albedo, normal and depth into the EXR too.")
        .add(
            "channels", [](auto& r) -> auto& { return r.params.channels; }, channels_codec(), "",
            "What the EXR holds beside the colour; with \"motion\" each frame asks for the next one.", "none");
    t.check = check_render;
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
        .add("movie", &O::movie, toggle(), "",
             "Joins the PNGs of all frames to a movie, where ffmpeg is installed; without output.png there is none.")
        .add("cache_limit", &O::cache_limit_gb, number({0, 1e9, false}), "GB",
             "Stored results beyond it are removed, those used longest ago first; 0: no limit.");
    return t;
  }();
  return table;
}

}  // namespace softreel
