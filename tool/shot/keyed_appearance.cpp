#include "tool/shot/keyed_appearance.h"

#include <algorithm>

namespace softreel {
namespace {

bool is_keys(const TomlValue& value) {
  const auto* items = value.array();
  return items != nullptr && (items->empty() || items->front().table() != nullptr);
}

/// The track of a material's member, or null. `of` gives the member that a track is of.
template <typename Member, typename Of>
const AppearanceTrack* find_track(const MaterialSettings& material, Member member, Of of) {
  const auto found = std::find_if(material.tracks.begin(), material.tracks.end(),
                                  [&](const AppearanceTrack& track) { return track.*of == member; });
  return found == material.tracks.end() ? nullptr : &*found;
}

/// Adds the plain field, then lets it take keys too. The reference describes frame, value and ease in words here, not
/// in three rows for each property. `of`, `values`: where an AppearanceTrack has member and track;
/// to_held: from a key's value to what the Appearance holds.
template <typename Plain, typename Value, typename Member, typename Of, typename Values, typename ToHeld>
void add(Table<MaterialSettings>& table, const std::string& name, Member member, const Plain& plain,
         const Codec<Value>& codec, const std::string& unit, const std::string& meaning, Of of, Values values,
         ToHeld to_held) {
  table.add(
      name, [member](auto& m) -> auto& { return m.appearance.*member; }, plain, unit, meaning);
  Field<MaterialSettings>& field = table.fields.back();
  const Codec<Track<Value>> keys = keyed(codec, unit);
  field.text.type = keys.type;
  field.text.accepted = keys.accepted;
  field.read = [=, read = field.read](const Place& place, const TomlValue& value, MaterialSettings& out) {
    if (!is_keys(value)) return read(place, value, out);
    AppearanceTrack track;
    track.*of = member;
    track.*values = keys.parse(place, value);
    if (!(track.*values).keys.empty()) out.appearance.*member = to_held((track.*values).keys.front().value);
    out.tracks.push_back(std::move(track));
  };
  field.write = [=, write = field.write](const MaterialSettings& in) -> std::optional<TomlValue> {
    const AppearanceTrack* track = find_track(in, member, of);
    return track != nullptr ? keys.print(track->*values) : write(in);
  };
}

}  // namespace

void add_keyed(Table<MaterialSettings>& table, const std::string& name, float Appearance::*member, const Range& range,
               const std::string& unit, const std::string& meaning) {
  add(table, name, member, single(range), widened(single(range)), unit, meaning, &AppearanceTrack::number,
      &AppearanceTrack::numbers, [](double value) { return static_cast<float>(value); });
}

void add_keyed(Table<MaterialSettings>& table, const std::string& name, Vec3f Appearance::*member, const Range& range,
               const std::string& unit, const std::string& meaning) {
  const Codec<Vec3f> colors = vector_of<Vec3f>(range, "[r, g, b]");
  add(table, name, member, colors, widened(colors), unit, meaning, &AppearanceTrack::color, &AppearanceTrack::colors,
      [](const Vec3& value) { return Vec3f(value.cast<float>()); });
}

}  // namespace softreel
