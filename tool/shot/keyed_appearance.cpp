#include "tool/shot/keyed_appearance.h"

#include <algorithm>

namespace softreel {
namespace {

bool is_keys(const TomlValue& value) {
  const auto* items = value.array();
  return items != nullptr && (items->empty() || items->front().table() != nullptr);
}

/// How an AppearanceTrack keeps the keys of a number.
struct NumberKeys {
  using Member = float Appearance::*;
  static constexpr auto kOf = &AppearanceTrack::number;
  static constexpr auto kValues = &AppearanceTrack::numbers;
  static float held(double value) { return static_cast<float>(value); }
};

/// The same for a colour.
struct ColorKeys {
  using Member = Vec3f Appearance::*;
  static constexpr auto kOf = &AppearanceTrack::color;
  static constexpr auto kValues = &AppearanceTrack::colors;
  static Vec3f held(const Vec3& value) { return value.cast<float>(); }
};

/// The track of a material's member, or null.
template <typename Keys>
const AppearanceTrack* find_track(const MaterialSettings& material, typename Keys::Member member) {
  const auto found = std::find_if(material.tracks.begin(), material.tracks.end(),
                                  [&](const AppearanceTrack& track) { return track.*Keys::kOf == member; });
  return found == material.tracks.end() ? nullptr : &*found;
}

/// Adds the plain field, then lets it take keys too. The reference describes frame, value and ease in words here, not
/// in three rows for each property.
template <typename Keys, typename Held>
void add(Table<MaterialSettings>& table, const std::string& name, typename Keys::Member member,
         const Codec<Held>& codec, const std::string& unit, const std::string& meaning) {
  table.add(
      name, [member](auto& m) -> auto& { return m.appearance.*member; }, codec, unit, meaning);
  Field<MaterialSettings>& field = table.fields.back();
  const auto keys = keyed(widened(codec), unit);
  field.text.type = keys.type;
  field.text.accepted = keys.accepted;
  field.read = [=, read = field.read](const Place& place, const TomlValue& value, MaterialSettings& out) {
    if (!is_keys(value)) return read(place, value, out);
    AppearanceTrack track;
    track.field = name;
    track.*Keys::kOf = member;
    auto& values = track.*Keys::kValues;
    values = keys.parse(place, value);
    if (!values.keys.empty()) out.appearance.*member = Keys::held(values.keys.front().value);
    out.tracks.push_back(std::move(track));
  };
  field.write = [=, write = field.write](const MaterialSettings& in) -> std::optional<TomlValue> {
    const AppearanceTrack* track = find_track<Keys>(in, member);
    return track != nullptr ? keys.print(track->*Keys::kValues) : write(in);
  };
}

}  // namespace

void add_keyed(Table<MaterialSettings>& table, const std::string& name, float Appearance::*member, const Range& range,
               const std::string& unit, const std::string& meaning) {
  add<NumberKeys>(table, name, member, single(range), unit, meaning);
}

void add_keyed(Table<MaterialSettings>& table, const std::string& name, Vec3f Appearance::*member, const Range& range,
               const std::string& unit, const std::string& meaning) {
  add<ColorKeys>(table, name, member, vector_of<Vec3f>(range, "[r, g, b]"), unit, meaning);
}

}  // namespace softreel
