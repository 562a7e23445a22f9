/// How single values of a shot are spelt: numbers with a range, choices, vectors, paths, values over frames.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/types.h"
#include "core/constraints/keys.h"
#include "tool/shot/schema_table.h"
#include "tool/shot/shot.h"

namespace softreel {

/// Which numbers a field takes; an end that is infinite is no end.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  ///< min itself is refused

  bool contains(double x) const { return (above_min ? x > min : x >= min) && x <= max; }
};

inline constexpr double kLargestSingle = std::numeric_limits<float>::max();
/// The same for a number that is computed on, or kept, in single precision: what that cannot hold is refused.
constexpr Range in_single(Range range) {
  if (range.min < -kLargestSingle) range.min = -kLargestSingle;
  if (range.max > kLargestSingle) range.max = kLargestSingle;
  return range;
}

inline constexpr double kNoEnd = std::numeric_limits<double>::infinity();
inline constexpr Range kAnyNumber{};
inline constexpr Range kPositive{0, kNoEnd, true};
inline constexpr Range kNotNegative{0, kNoEnd, false};
inline constexpr Range kShare{0, 1, false};
/// How a colour is spelt.
inline constexpr const char* kColorType = "[r, g, b]";

/// Whether an end of a range says something of the field: infinity and the largest single do not.
bool is_end(double x);
/// "above 0", "0 to 1", "any".
std::string to_text(const Range& range);

/// A finite number in range. Throws value_error.
double parse_number(const Place& place, const TomlValue& value, const Range& range);
/// A whole number from min to max; 2e4 is one too. Throws value_error.
std::int64_t parse_whole(const Place& place, const TomlValue& value, std::int64_t min, std::int64_t max);
/// A list of exactly `count` numbers. Throws value_error.
std::vector<double> parse_numbers(const Place& place, const TomlValue& value, std::size_t count, const Range& range);
/// A number as a TOML value; singles in the fewest digits that read back as the same single.
TomlValue print_number(double value);
TomlValue print_number(float value);

Codec<double> number(const Range& range);
/// Kept in single precision.
Codec<float> single(const Range& range);
/// The same values in a wider type, for tracks, which blend in double.
Codec<double> widened(const Codec<float>& codec);
Codec<Vec3> widened(const Codec<Vec3f>& codec);
Codec<bool> toggle();
Codec<std::string> text();
/// Text that can be part of a file's name.
inline constexpr const char* kFileNameAccepted =
    "text that can be part of a file's name: no '/', no control characters, not '.' or '..'";
bool is_file_name(const std::string& name);
Codec<std::string> file_name();
/// Reads "0.3%" (of the diagonal of a body's box, up to 50 %) or a number: a length above 0. None if it is neither.
std::optional<BodyLength> parse_body_length(const std::string& text);
/// A number in m, or a share of the diagonal as text with a % sign.
Codec<BodyLength> body_length();

/// A share as text with a % sign, "0.5%", above 0 up to 50 %; 0: left out.
Codec<double> percent();

/// A path, relative to the file that says it (or to the working directory in an override); printed absolute, so that a
/// written shot can lie anywhere. An empty path is left out.
Codec<std::string> file_path();

/// Degrees in the file, radians in the struct; printed so that reading gives the same bits.
Codec<float> degrees_single(const Range& range);
double to_radians(double degrees);
double to_degrees(double radians);

template <typename T>
Codec<T> whole(std::int64_t min, std::int64_t max) {
  Codec<T> codec;
  codec.type = "whole number";
  codec.accepted = std::to_string(min) + " to " + std::to_string(max);
  codec.parse = [min, max](const Place& place, const TomlValue& value) {
    return static_cast<T>(parse_whole(place, value, min, max));
  };
  codec.print = [](const T& value) { return toml_value(static_cast<std::int64_t>(value)); };
  return codec;
}

/// One of a few names. Throws value_error with the nearest one.
std::size_t parse_choice(const Place& place, const TomlValue& value, const std::vector<std::string>& names);
std::string choices_text(const std::vector<std::string>& names);

template <typename E>
Codec<E> choice(const std::vector<std::pair<std::string, E>>& options) {
  std::vector<std::string> names;
  for (const auto& option : options) names.push_back(option.first);
  Codec<E> codec;
  codec.type = "text";
  codec.accepted = choices_text(names);
  codec.parse = [options, names](const Place& place, const TomlValue& value) {
    return options[parse_choice(place, value, names)].second;
  };
  codec.print = [options](const E& value) -> std::optional<TomlValue> {
    for (const auto& [name, option] : options)
      if (option == value) return toml_value(name);
    return std::nullopt;
  };
  return codec;
}

/// A fixed-size vector: [x, y, z]. `type` names its parts.
template <typename V>
Codec<V> vector_of(const Range& range, const std::string& type = "[x, y, z]") {
  using Scalar = typename V::Scalar;
  constexpr auto kSize = static_cast<std::size_t>(V::SizeAtCompileTime);
  const Range held = std::is_same_v<Scalar, float> ? in_single(range) : range;
  Codec<V> codec;
  codec.type = type;
  const bool any = !is_end(range.min) && !is_end(range.max);
  codec.accepted = std::to_string(kSize) + (any ? " finite numbers" : " numbers, each " + to_text(range));
  codec.parse = [held](const Place& place, const TomlValue& value) {
    const std::vector<double> numbers = parse_numbers(place, value, kSize, held);
    V out;
    for (std::size_t i = 0; i < kSize; ++i) out[static_cast<Eigen::Index>(i)] = static_cast<Scalar>(numbers[i]);
    return out;
  };
  codec.print = [](const V& in) {
    TomlValue::Array items;
    for (const Scalar x : in) items.push_back(print_number(x));
    return toml_value(std::move(items));
  };
  return codec;
}

/// The codec of a value that may be missing.
template <typename T>
Codec<std::optional<T>> optional_of(const Codec<T>& codec) {
  Codec<std::optional<T>> optional;
  optional.type = codec.type;
  optional.accepted = codec.accepted;
  optional.parts = codec.parts;
  optional.parse = [parse = codec.parse](const Place& place, const TomlValue& value) {
    return std::optional<T>(parse(place, value));
  };
  optional.print = [print = codec.print](const std::optional<T>& value) -> std::optional<TomlValue> {
    if (!value) return std::nullopt;
    return print(*value);
  };
  return optional;
}

/// The codec of a number whose 0 means "not given".
template <typename T>
Codec<T> absent_if_zero(Codec<T> codec) {
  codec.print = [print = codec.print](const T& value) -> std::optional<TomlValue> {
    if (value == T{}) return std::nullopt;
    return print(value);
  };
  return codec;
}

/// Checks what a list of keys must be: not empty, frames strictly rising. Throws value_error.
void check_key_frames(const Place& place, const TomlValue& list, const std::vector<double>& frames);

/// How a key moves on, in the words of a shot.
Codec<Ease> ease_codec();

/// One key as the file says it.
template <typename T>
struct KeyText {
  double frame = 0;
  T value{};
  Ease ease = Ease::Smooth;
};

/// A value, or a list of keys { frame, value, ease }.
template <typename T>
Codec<Track<T>> keyed(const Codec<T>& codec, const std::string& unit);

// ----------------------------------------------------------------------------------------------------------------------

template <typename T>
Table<KeyText<T>> key_table(const Codec<T>& codec, const std::string& unit) {
  Table<KeyText<T>> table;
  table.sentence = "A value at a frame.";
  table.require("frame", &KeyText<T>::frame, number(kAnyNumber), "frames", "When the value holds.")
      .require("value", &KeyText<T>::value, codec, unit, "The value at that frame.")
      .add("ease", &KeyText<T>::ease, ease_codec(), "", "How the value moves to the next key.");
  return table;
}

template <typename T>
Codec<Track<T>> keyed(const Codec<T>& codec, const std::string& unit) {
  Codec<Track<T>> keys;
  const Table<KeyText<T>> table = key_table(codec, unit);
  keys.type = codec.type + " or list of keys";
  keys.accepted = codec.accepted + "; or keys { frame, value, ease } with rising frames";
  keys.parts = table_texts(table, "[].");
  keys.parse = [codec, table](const Place& place, const TomlValue& value) {
    const auto* items = value.array();
    const bool is_list = items != nullptr && (items->empty() || items->front().table() != nullptr);
    if (!is_list) return Track<T>{{{0, codec.parse(place, value), Ease::Smooth}}};
    Track<T> track;
    std::vector<double> frames;
    const std::size_t problems_before = place.problems->size();
    for (const TomlValue& item : *items) {
      KeyText<T> key;
      read_table(table, place.item(frames.size()), item, key);
      frames.push_back(key.frame);
      track.keys.push_back({key.frame, key.value, key.ease});
    }
    if (place.problems->size() == problems_before) check_key_frames(place, value, frames);
    return track;
  };
  keys.print = [codec, table](const Track<T>& track) -> std::optional<TomlValue> {
    if (track.keys.empty()) return std::nullopt;
    const Key<T>& first = track.keys.front();
    if (track.keys.size() == 1 && first.frame == 0 && first.ease == Ease::Smooth) return codec.print(first.value);
    TomlValue::Array items;
    for (const Key<T>& key : track.keys)
      items.push_back(write_table(table, KeyText<T>{key.frame, key.value, key.ease}));
    return toml_value(std::move(items));
  };
  return keys;
}

}  // namespace softreel
