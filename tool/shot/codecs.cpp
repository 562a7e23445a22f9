#include "tool/shot/codecs.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "core/base/nearest_name.h"
#include "tool/shot/plain_path.h"

namespace softreel {
namespace {

/// Whole numbers above this have neighbours that a double cannot tell apart.
constexpr double kLargestExactWhole = 9007199254740992.0;

/// The number that a decimal spells; infinite if it is too large for a double.
double decimal(const std::string& digits) {
  double number = kNoEnd;
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return number;
}

/// The number with the fewest digits, near `guess`, that `forward` maps to exactly `wanted`.
template <typename T, typename Forward>
double invert_exactly(const Forward& forward, T wanted, double guess) {
  for (int digits = 1; digits <= 17; ++digits) {
    const double candidate = decimal(fmt::format("{:.{}g}", guess, digits));
    if (forward(candidate) == wanted) return candidate;
  }
  double below = guess, above = guess;
  for (int step = 0; step < 8; ++step) {
    below = std::nextafter(below, -kNoEnd);
    above = std::nextafter(above, kNoEnd);
    if (forward(below) == wanted) return below;
    if (forward(above) == wanted) return above;
  }
  return guess;
}

}  // namespace

bool is_end(double x) {
  return std::abs(x) < kLargestSingle;
}

std::string to_text(const Range& range) {
  const bool has_min = is_end(range.min), has_max = is_end(range.max);
  const auto end = [](double x) { return fmt::format("{}", x); };
  if (!has_min && !has_max) return "any finite number";
  if (!has_max) return range.above_min ? "above " + end(range.min) : end(range.min) + " or more";
  if (!has_min) return end(range.max) + " or less";
  if (range.above_min) return "above " + end(range.min) + ", up to " + end(range.max);
  return end(range.min) + " to " + end(range.max);
}

double parse_number(const Place& place, const TomlValue& value, const Range& range) {
  double number = 0;
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) {
    number = static_cast<double>(*whole);
  } else if (const auto* real = std::get_if<double>(&value.data)) {
    number = *real;
  } else {
    throw value_error(place, value, "it is " + kind_name(value) + ", not a number");
  }
  if (!std::isfinite(number)) throw value_error(place, value, "it is not finite");
  if (range.contains(number)) return number;
  // What is accepted names no such end.
  const bool is_beyond_single = std::abs(number) > kLargestSingle;
  throw value_error(place, value,
                    is_beyond_single ? fmt::format("it is out of range: numbers end at {:.2g} here", kLargestSingle)
                                     : "it is out of range");
}

std::int64_t parse_whole(const Place& place, const TomlValue& value, std::int64_t min, std::int64_t max) {
  std::int64_t number = 0;
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) {
    number = *whole;
  } else if (const auto* real = std::get_if<double>(&value.data)) {
    if (!std::isfinite(*real)) throw value_error(place, value, "it is not finite");
    if (*real != std::floor(*real)) throw value_error(place, value, "it is not a whole number");
    if (std::abs(*real) > kLargestExactWhole) throw value_error(place, value, "it is out of range");
    number = static_cast<std::int64_t>(*real);
  } else {
    throw value_error(place, value, "it is " + kind_name(value) + ", not a whole number");
  }
  if (number < min || number > max) throw value_error(place, value, "it is out of range");
  return number;
}

std::vector<double> parse_numbers(const Place& place, const TomlValue& value, std::size_t count, const Range& range) {
  const auto* items = value.array();
  if (items == nullptr)
    throw value_error(place, value, fmt::format("it is {}, not a list of {} numbers", kind_name(value), count));
  if (items->size() != count)
    throw value_error(place, value, fmt::format("the list has {} values, not {}", items->size(), count));
  std::vector<double> numbers;
  for (const TomlValue& item : *items) numbers.push_back(parse_number(place.item(numbers.size()), item, range));
  return numbers;
}

TomlValue print_number(double value) {
  return toml_value(value);
}

TomlValue print_number(float value) {
  // The shortest decimal of the single, as a double: it prints as short and reads back as the same single.
  return toml_value(decimal(fmt::format("{}", value)));
}

Codec<double> number(const Range& range) {
  Codec<double> codec;
  codec.type = "number";
  codec.accepted = to_text(range);
  codec.parse = [range](const Place& place, const TomlValue& value) { return parse_number(place, value, range); };
  codec.print = [](const double& value) { return print_number(value); };
  return codec;
}

Codec<float> single(const Range& range) {
  Codec<float> codec;
  codec.type = "number";
  codec.accepted = to_text(range);
  codec.parse = [held = in_single(range)](const Place& place, const TomlValue& value) {
    return static_cast<float>(parse_number(place, value, held));
  };
  codec.print = [](const float& value) { return print_number(value); };
  return codec;
}

namespace {

template <typename Wide, typename Narrow>
Codec<Wide> widened_by(const Codec<Narrow>& codec, Wide (*widen)(const Narrow&), Narrow (*narrow)(const Wide&)) {
  Codec<Wide> wide;
  wide.type = codec.type;
  wide.accepted = codec.accepted;
  wide.parts = codec.parts;
  wide.parse = [parse = codec.parse, widen](const Place& place, const TomlValue& value) {
    return widen(parse(place, value));
  };
  wide.print = [print = codec.print, narrow](const Wide& value) { return print(narrow(value)); };
  return wide;
}

}  // namespace

Codec<double> widened(const Codec<float>& codec) {
  return widened_by<double, float>(
      codec, [](const float& x) { return static_cast<double>(x); },
      [](const double& x) { return static_cast<float>(x); });
}

Codec<Vec3> widened(const Codec<Vec3f>& codec) {
  return widened_by<Vec3, Vec3f>(
      codec, [](const Vec3f& v) { return Vec3(v.cast<double>()); },
      [](const Vec3& v) { return Vec3f(v.cast<float>()); });
}

Codec<bool> toggle() {
  Codec<bool> codec;
  codec.type = "true or false";
  codec.accepted = "true or false";
  codec.parse = [](const Place& place, const TomlValue& value) {
    const auto* flag = std::get_if<bool>(&value.data);
    if (flag == nullptr) throw value_error(place, value, "it is " + kind_name(value) + ", not true or false");
    return *flag;
  };
  codec.print = [](const bool& value) { return toml_value(value); };
  return codec;
}

Codec<std::string> text() {
  Codec<std::string> codec;
  codec.type = "text";
  codec.accepted = "text in quotes, not empty";
  codec.parse = [](const Place& place, const TomlValue& value) {
    if (value.text() == nullptr) throw value_error(place, value, "it is " + kind_name(value) + ", not text");
    if (value.text()->empty()) throw value_error(place, value, "it is empty");
    return *value.text();
  };
  codec.print = [](const std::string& value) -> std::optional<TomlValue> {
    if (value.empty()) return std::nullopt;
    return toml_value(value);
  };
  return codec;
}

bool is_file_name(const std::string& name) {
  const bool bad_letter = std::any_of(name.begin(), name.end(), [](char c) {
    return c == '/' || static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7f;
  });
  return !name.empty() && !bad_letter && name != "." && name != "..";
}

Codec<std::string> file_name() {
  Codec<std::string> codec = text();
  codec.accepted = kFileNameAccepted;
  codec.parse = [parse = codec.parse](const Place& place, const TomlValue& value) {
    std::string name = parse(place, value);
    if (!is_file_name(name)) throw value_error(place, value, "files are named after it");
    return name;
  };
  return codec;
}

std::optional<BodyLength> parse_body_length(const std::string& text) {
  constexpr double kMostPercent = 50;
  const bool is_share = !text.empty() && text.back() == '%';
  const char* const end = text.data() + text.size() - (is_share ? 1 : 0);
  double value = 0;
  const auto [stopped, code] = std::from_chars(text.data(), end, value);
  if (code != std::errc{} || stopped != end || !(value > 0) || !std::isfinite(value)) return std::nullopt;
  if (is_share && value > kMostPercent) return std::nullopt;
  return BodyLength{is_share ? value / 100 : value, is_share};
}

namespace {

/// "0.5%", which reads back as the same bits.
std::string percent_text(double share) {
  return fmt::format("{}%", invert_exactly([](double p) { return p / 100; }, share, share * 100));
}

}  // namespace

Codec<BodyLength> body_length() {
  Codec<BodyLength> codec;
  codec.type = "number or percent";
  codec.accepted = "above 0, or a share of the diagonal of the body's box in quotes: \"0.3%\", up to 50 %";
  codec.parse = [](const Place& place, const TomlValue& value) {
    if (value.text() == nullptr) return BodyLength{parse_number(place, value, kPositive), false};
    const std::optional<BodyLength> length = parse_body_length(*value.text());
    if (!length) throw value_error(place, value, "it is no length");
    return *length;
  };
  codec.print = [](const BodyLength& length) -> std::optional<TomlValue> {
    if (length.value == 0) return std::nullopt;
    if (!length.is_share) return print_number(length.value);
    return toml_value(percent_text(length.value));
  };
  return codec;
}

Codec<double> percent() {
  Codec<double> codec;
  codec.type = "percent";
  codec.accepted = "a share in quotes, above 0 and up to 50 %: \"0.5%\"";
  codec.parse = [](const Place& place, const TomlValue& value) {
    const std::optional<BodyLength> share = value.text() ? parse_body_length(*value.text()) : std::nullopt;
    if (!share || !share->is_share) throw value_error(place, value, "it is no share");
    return share->value;
  };
  codec.print = [](const double& share) -> std::optional<TomlValue> {
    if (share == 0) return std::nullopt;
    return toml_value(percent_text(share));
  };
  return codec;
}

Codec<std::string> file_path() {
  Codec<std::string> codec = text();
  codec.type = "path";
  codec.accepted = "a path in quotes, relative to the file that says it (with --set: to the working directory)";
  codec.parse = [parse = codec.parse](const Place& place, const TomlValue& value) {
    const std::filesystem::path path = parse(place, value);
    if (path.native().find('\0') != std::string::npos) throw value_error(place, value, "it holds a null character");
    if (value.origin.line == 0 || path.is_absolute()) return plain_path(path).string();
    return plain_path(std::filesystem::path(value.origin.file).parent_path() / path).string();
  };
  codec.print = [](const std::string& value) -> std::optional<TomlValue> {
    if (value.empty()) return std::nullopt;
    return toml_value(plain_path(std::filesystem::absolute(value)).string());
  };
  return codec;
}

double to_radians(double degrees) {
  return degrees * (std::numbers::pi / 180);
}

double to_degrees(double radians) {
  return invert_exactly(to_radians, radians, radians * (180 / std::numbers::pi));
}

Codec<float> degrees_single(const Range& range) {
  Codec<float> codec = single(range);
  const auto forward = [](double degrees) { return static_cast<float>(to_radians(degrees)); };
  codec.parse = [forward, held = in_single(range)](const Place& place, const TomlValue& value) {
    return forward(parse_number(place, value, held));
  };
  codec.print = [forward](const float& radians) {
    return print_number(invert_exactly(forward, radians, static_cast<double>(radians) * (180 / std::numbers::pi)));
  };
  return codec;
}

std::size_t parse_choice(const Place& place, const TomlValue& value, const std::vector<std::string>& names) {
  if (value.text() == nullptr) throw value_error(place, value, "it is " + kind_name(value) + ", not text");
  const auto found = std::find(names.begin(), names.end(), *value.text());
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const std::string nearest = nearest_name(*value.text(), names);
  throw value_error(place, value, "it is none of the choices",
                    nearest.empty() ? "" : fmt::format("Did you mean \"{}\"?", nearest));
}

std::string choices_text(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " or " : ", ";
    out += "\"" + names[i] + "\"";
  }
  return out;
}

void check_key_frames(const Place& place, const TomlValue& list, const std::vector<double>& frames) {
  if (frames.empty())
    throw value_error(place, list, "the list has no key", "Add a key { frame = 1, ... }, or leave the field out.");
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (frames[i] <= frames[i - 1]) {
      const TomlValue& item = (*list.array())[i];
      throw value_error(
          place.item(i), item,
          fmt::format("its frame {} does not come after the frame {} of the key before it", frames[i], frames[i - 1]),
          "Sort the keys by frame, one key a frame.");
    }
}

Codec<Ease> ease_codec() {
  return choice<Ease>({{"constant", Ease::Constant}, {"linear", Ease::Linear}, {"smooth", Ease::Smooth}});
}

}  // namespace softreel
