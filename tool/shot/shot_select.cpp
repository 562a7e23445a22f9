#include "tool/shot/shot_select.h"

#include <fmt/format.h>

#include "tool/shot/shot_follow.h"

namespace softreel {
namespace {

/// A term of a selection as the file says it: one of its shapes is there.
struct TermText {
  std::optional<SelectBox> box;
  std::optional<SelectSphere> sphere;
  std::optional<SelectPlane> plane;
  std::optional<SelectNearest> nearest;
  std::optional<std::string> group;
  bool all = false;
  std::optional<WeightSource> weights;
  std::optional<double> threshold;
  SelectionUnit unit = SelectionUnit::Meter;
};

/// A threshold of 0 would take what is not painted.
constexpr Range kThreshold{0, 1, true};
constexpr const char* kSelectionUnit = "m or box";

const Table<SelectBox>& box_table() {
  static const Table<SelectBox> table = [] {
    Table<SelectBox> t;
    t.sentence = "Points inside a box, its faces included.";
    t.require("min", &SelectBox::min, vector_of<Vec3>(kAnyNumber), kSelectionUnit, "Lowest corner.")
        .require("max", &SelectBox::max, vector_of<Vec3>(kAnyNumber), kSelectionUnit, "Highest corner.");
    t.check = [](const Place& place, const TomlValue& value, SelectBox& box) {
      if ((box.min.array() <= box.max.array()).all()) return;
      const FieldText text{"", "", "", "", "a min that is not above the max, along each axis", "", false, false};
      throw value_error({place.path, &text, place.problems}, value, "its min is above its max along an axis",
                        "Exchange the two numbers.");
    };
    return t;
  }();
  return table;
}

const Table<SelectSphere>& sphere_table() {
  static const Table<SelectSphere> table = [] {
    Table<SelectSphere> t;
    t.sentence = "Points inside a sphere.";
    t.require("center", &SelectSphere::center, vector_of<Vec3>(kAnyNumber), kSelectionUnit, "Its centre.")
        .require("radius", &SelectSphere::radius, number(kPositive), "m or heights of the box", "Its radius.");
    return t;
  }();
  return table;
}

const Table<SelectPlane>& plane_table() {
  static const Table<SelectPlane> table = [] {
    Table<SelectPlane> t;
    t.sentence = "Points on the side of a plane that its normal points to.";
    t.require("point", &SelectPlane::point, vector_of<Vec3>(kAnyNumber), kSelectionUnit, "A point of the plane.")
        .require("normal", &SelectPlane::normal, vector_of<Vec3>(kAnyNumber), "", "Its normal, of any length above 0.");
    t.check = [](const Place& place, const TomlValue& value, SelectPlane& plane) {
      if (!plane.normal.isZero(0)) return;
      const FieldText text{"", "", "", "", "a normal of any length above 0", "", false, false};
      throw value_error({place.path, &text, place.problems}, value, "its normal has no length", "Give a direction.");
    };
    return t;
  }();
  return table;
}

const Table<SelectNearest>& nearest_table() {
  static const Table<SelectNearest> table = [] {
    Table<SelectNearest> t;
    t.sentence = "The points nearest to a place.";
    t.require("point", &SelectNearest::point, vector_of<Vec3>(kAnyNumber), kSelectionUnit, "The place.")
        .add("count", &SelectNearest::count, whole<Index>(1, 1000000000), "points", "How many are taken.", "1");
    return t;
  }();
  return table;
}

void check_term(const Place& place, const TomlValue& value, TermText& term) {
  const int shapes = int{term.box.has_value()} + int{term.sphere.has_value()} + int{term.plane.has_value()} +
                     int{term.nearest.has_value()} + int{term.group.has_value()} + int{term.all} +
                     int{term.weights.has_value()};
  if (shapes == 1 && term.threshold && !term.weights)
    throw value_error(place, value, "it has a threshold, but no weights", "Remove the threshold.");
  if (shapes == 1) return;
  throw value_error(place, value, shapes == 0 ? "it has no shape" : "it has several shapes",
                    "Give one shape; a list of selections is their union.");
}

const Table<TermText>& term_table() {
  static const Table<TermText> table = [] {
    Table<TermText> t;
    t.sentence = "Which points are taken.";
    t.add_optional_table("box", &TermText::box, box_table())
        .add_optional_table("sphere", &TermText::sphere, sphere_table())
        .add_optional_table("plane", &TermText::plane, plane_table())
        .add_optional_table("nearest", &TermText::nearest, nearest_table())
        .add("group", &TermText::group, optional_of(text()), "", "Points of a named group or material of the mesh.")
        .add("all", &TermText::all, absent_if_zero(toggle()), "", "All points.", "false")
        .add("weights", &TermText::weights, weights_codec(), "", "Points whose painted weight reaches the threshold.")
        .add("threshold", &TermText::threshold, optional_of(number(kThreshold)), "", "Least weight that is taken.",
             "0.5")
        .add("unit", &TermText::unit, choice<SelectionUnit>({{"m", SelectionUnit::Meter}, {"box", SelectionUnit::Box}}),
             "", "What the numbers count: metres in the scene, or 0 to 1 along each axis of the placed body's box.");
    t.check = check_term;
    return t;
  }();
  return table;
}

SelectionTerm to_term(const TermText& text) {
  if (text.box) return {*text.box, text.unit};
  if (text.sphere) return {*text.sphere, text.unit};
  if (text.plane) return {*text.plane, text.unit};
  if (text.nearest) return {*text.nearest, text.unit};
  if (text.group) return {SelectGroup{*text.group}, text.unit};
  if (text.weights)
    return {SelectWeights{*text.weights, text.threshold.value_or(SelectWeights{}.threshold)}, text.unit};
  return {SelectAll{}, text.unit};
}

TomlValue print_term(const SelectionTerm& term) {
  TermText text;
  text.unit = term.unit;
  if (const auto* box = std::get_if<SelectBox>(&term.shape)) text.box = *box;
  if (const auto* sphere = std::get_if<SelectSphere>(&term.shape)) text.sphere = *sphere;
  if (const auto* plane = std::get_if<SelectPlane>(&term.shape)) text.plane = *plane;
  if (const auto* nearest = std::get_if<SelectNearest>(&term.shape)) text.nearest = *nearest;
  if (const auto* group = std::get_if<SelectGroup>(&term.shape)) text.group = group->name;
  if (const auto* painted = std::get_if<SelectWeights>(&term.shape)) {
    text.weights = painted->source;
    text.threshold = painted->threshold;
  }
  text.all = std::holds_alternative<SelectAll>(term.shape);
  return write_table(term_table(), text);
}

FrameRange parse_range(const Place& place, const TomlValue& value) {
  const std::vector<double> ends = parse_numbers(place, value, 2, kAnyNumber);
  if (ends[0] > ends[1]) throw value_error(place, value, "it ends before it begins", "Exchange the two frames.");
  return {ends[0], ends[1]};
}

TomlValue print_range(const FrameRange& range) {
  return toml_value(TomlValue::Array{toml_value(range.first), toml_value(range.last)});
}

/// A key of a pin or pull as the file says it.
struct TransformKeyText {
  double frame = 0;
  Vec3 translate = Vec3::Zero(), rotate = Vec3::Zero(), scale = Vec3::Ones();
  std::optional<Vec3> pivot;
  Ease ease = Ease::Smooth;
};

/// Degrees in the file, radians here.
Codec<Vec3> rotation_codec() {
  Codec<Vec3> codec = vector_of<Vec3>(kAnyNumber);
  codec.parse = [parse = codec.parse](const Place& place, const TomlValue& value) -> Vec3 {
    return parse(place, value).unaryExpr(&to_radians);
  };
  codec.print = [print = codec.print](const Vec3& radians) { return print(radians.unaryExpr(&to_degrees)); };
  return codec;
}

const Table<TransformKeyText>& transform_key_table() {
  static const Table<TransformKeyText> table = [] {
    using K = TransformKeyText;
    Table<K> t;
    t.sentence = "Where the points are at a frame, against where they rest.";
    t.require("frame", &K::frame, number(kAnyNumber), "frames", "When the points are there.")
        .add("translate", &K::translate, vector_of<Vec3>(kAnyNumber), "m or heights of the box", "Moves the points.")
        .add("rotate_deg", &K::rotate, rotation_codec(), "degrees",
             "Turns them about the fixed axes through the pivot: x first, then y, then z; 360 is a full turn.")
        .add("scale", &K::scale, vector_of<Vec3>(kAnyNumber), "", "Stretches them along the axes from the pivot.")
        .add("pivot", &K::pivot, optional_of(vector_of<Vec3>(kAnyNumber)), "m or box",
             "Centre of rotation and scale; a key without one takes that of the nearest key before it, else after it.",
             "centroid of the selected points")
        .add("ease", &K::ease, ease_codec(), "", "How the points move to the next key.");
    return t;
  }();
  return table;
}

Motion parse_motion(const Place& place, const TomlValue& value) {
  if (value.array() == nullptr) throw value_error(place, value, "it is " + kind_name(value) + ", not a list of keys");
  std::vector<double> frames;
  std::vector<TransformKeyText> texts;
  const std::size_t problems_before = place.problems->size();
  for (const TomlValue& item : *value.array()) {
    const Place at = place.item(texts.size());
    read_table(transform_key_table(), at, item, texts.emplace_back());
    frames.push_back(texts.back().frame);
  }
  Motion motion;
  if (place.problems->size() != problems_before) return motion;
  check_key_frames(place, value, frames);
  Vec3 pivot = Vec3::Zero();
  for (const TransformKeyText& key : texts)
    if (key.pivot && !motion.pivot_given) {
      pivot = *key.pivot;
      motion.pivot_given = true;
    }
  for (const TransformKeyText& key : texts) {
    pivot = key.pivot.value_or(pivot);
    motion.track.keys.push_back({key.frame, {key.translate, key.rotate, key.scale, pivot}, key.ease});
  }
  return motion;
}

std::optional<TomlValue> print_motion(const Motion& motion) {
  if (motion.track.keys.empty()) return std::nullopt;
  TomlValue::Array items;
  for (const Key<Transform>& key : motion.track.keys) {
    TransformKeyText text{key.frame, key.value.translate, key.value.rotate, key.value.scale, std::nullopt, key.ease};
    if (motion.pivot_given) text.pivot = key.value.pivot;
    items.push_back(write_table(transform_key_table(), text));
  }
  return toml_value(std::move(items));
}

}  // namespace

Codec<Selection> selection_codec() {
  Codec<Selection> codec;
  codec.type = "selection";
  codec.accepted =
      "{ box | sphere | plane | nearest | group | weights | all = ..., unit = ... } or a list of these, their union";
  codec.parts = table_texts(term_table(), ".");
  codec.parse = [](const Place& place, const TomlValue& value) {
    Selection selection;
    const auto* items = value.array();
    const std::size_t count = items == nullptr ? 1 : items->size();
    if (count == 0) throw value_error(place, value, "the list is empty", "Add a selection.");
    for (std::size_t i = 0; i < count; ++i) {
      TermText term;
      const Place at = items == nullptr ? place : place.item(i);
      read_table(term_table(), at, items == nullptr ? value : (*items)[i], term);
      selection.terms.push_back(to_term(term));
    }
    return selection;
  };
  codec.print = [](const Selection& selection) -> std::optional<TomlValue> {
    if (selection.terms.empty()) return std::nullopt;
    if (selection.terms.size() == 1) return print_term(selection.terms.front());
    TomlValue::Array items;
    for (const SelectionTerm& term : selection.terms) items.push_back(print_term(term));
    return toml_value(std::move(items));
  };
  return codec;
}

Codec<std::vector<FrameRange>> frame_ranges_codec() {
  Codec<std::vector<FrameRange>> codec;
  codec.type = "[first, last] or list of these";
  codec.accepted = "first frame and last frame, not below the first; or a list of such pairs";
  codec.parse = [](const Place& place, const TomlValue& value) {
    const auto* items = value.array();
    if (items == nullptr) throw value_error(place, value, "it is " + kind_name(value) + ", not a list");
    if (items->empty()) throw value_error(place, value, "the list is empty: it would never be active");
    if (items->front().array() == nullptr) return std::vector<FrameRange>{parse_range(place, value)};
    std::vector<FrameRange> ranges;
    for (const TomlValue& item : *items) ranges.push_back(parse_range(place.item(ranges.size()), item));
    return ranges;
  };
  codec.print = [](const std::vector<FrameRange>& ranges) -> std::optional<TomlValue> {
    if (ranges.empty()) return std::nullopt;
    if (ranges.size() == 1) return print_range(ranges.front());
    TomlValue::Array items;
    for (const FrameRange& range : ranges) items.push_back(print_range(range));
    return toml_value(std::move(items));
  };
  return codec;
}

Codec<Motion> motion_codec() {
  Codec<Motion> codec;
  codec.type = "list of keys";
  codec.accepted = "keys { frame, translate, rotate_deg, scale, pivot, ease } with rising frames";
  codec.parts = table_texts(transform_key_table(), "[].");
  codec.parse = parse_motion;
  codec.print = print_motion;
  return codec;
}

}  // namespace softreel
