#include "tool/stages/golden_record.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "tool/bodies/weight_maps.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/base64.h"
#include "tool/cache/json_text.h"
#include "tool/shot/shot_load.h"
#include "tool/stages/settings_snapshot.h"

namespace softreel {
namespace {

constexpr int kRecordFormat = 1;
constexpr std::size_t kFieldsNamed = 4;  ///< of changed ones, in a message

std::string bare_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// The shot without what moves no pixel: paths (of files by name only), output, threads.
Shot without_places(Shot shot) {
  for (BodySettings& body : shot.bodies) body.mesh = body.tetrahedra = "";
  // The slash keeps the name from being completed by the working directory.
  const auto keep_name = [](std::string& path) {
    if (!path.empty()) path = "/" + bare_name(path);
  };
  keep_name(shot.environment_image);
  for (auto& [name, material] : shot.materials)
    for (std::string* path : material.textures.paths()) keep_name(*path);
  for (BodySettings& body : shot.bodies)
    for (std::string* path : constraint_files(body, shot.glues)) keep_name(*path);
  const OutputSettings output = shot.output;
  shot.output = {};
  shot.output.view = output.view;
  shot.output.exposure = output.exposure;
  shot.golden = {};
  shot.threads = 0;
  return shot;
}

/// A shot of the same bodies, materials and lights with nothing else said: what fields are unless somebody sets them.
Shot all_default(const Shot& shot) {
  Shot plain;
  plain.settings.name = shot.settings.name;
  for (const BodySettings& body : shot.bodies) plain.bodies.emplace_back().name = body.name;
  for (const auto& [name, material] : shot.materials) plain.materials[name] = {};
  for (const LightSettings& light : shot.lights) plain.lights.emplace_back().kind = light.kind;
  if (shot.ground) plain.ground.emplace();
  return plain;
}

std::string in_words(double meters) {
  if (meters >= 1) return fmt::format("{:.3g} m", meters);
  if (meters >= 1e-3) return fmt::format("{:.3g} mm", 1e3 * meters);
  if (meters >= 1e-6) return fmt::format("{:.3g} um", 1e6 * meters);
  return fmt::format("{:.2g} m", meters);
}

/// Fields that differ, as "FIELD before -> after"; those that came with a newer program and are not set are none.
std::vector<std::string> changed_fields(const SettingsSnapshot& before, const SettingsSnapshot& after) {
  std::set<std::string> set_by_somebody;
  for (const FieldChange& change : find_changes({{"shot", after.at("unset")}}, {{"shot", after.at("shot")}}))
    set_by_somebody.insert(change.field);
  std::vector<std::string> fields;
  SettingsSnapshot old = before, now = after;
  old.erase("unset");
  now.erase("unset");
  for (const FieldChange& change : find_changes(old, now)) {
    if (change.before.empty() && set_by_somebody.count(change.field) == 0) continue;
    if (change.field.starts_with("content of "))
      fields.push_back(change.field);
    else
      fields.push_back(fmt::format("{} {} -> {}", change.field, change.before.empty() ? "none" : change.before,
                                   change.after.empty() ? "none" : change.after));
  }
  return fields;
}

std::string first_of(std::vector<std::string> fields) {
  if (fields.size() > kFieldsNamed) {
    const std::size_t more = fields.size() - kFieldsNamed;
    fields.resize(kFieldsNamed);
    fields.push_back(fmt::format("and {} more", more));
  }
  return fmt::format("{}", fmt::join(fields, "; "));
}

/// Empty if the geometry is the same.
std::string geometry_change(const GoldenGeometry& before, const GoldenGeometry& now) {
  double farthest = 0;
  std::string where;
  std::size_t looked_at = 0, vertices = 0;
  bool is_same = true;
  for (const auto& [body, surface] : now) {
    const auto found = before.find(body);
    if (found == before.end()) return fmt::format("the body '{}' is new", body);
    const GoldenSurface& old = found->second;
    if (old.vertices != surface.vertices || old.sample.size() != surface.sample.size())
      return fmt::format("the surface of '{}' has {} vertices, it had {}", body, surface.vertices, old.vertices);
    is_same = is_same && old.hash == surface.hash;
    looked_at += surface.sample.size();
    vertices += static_cast<std::size_t>(surface.vertices);
    for (std::size_t k = 0; k < surface.sample.size(); ++k) {
      const double distance = static_cast<double>((surface.sample[k] - old.sample[k]).norm());
      if (distance <= farthest) continue;
      farthest = distance;
      where = fmt::format("'{}' vertex {}", body, sampled_vertex(k, static_cast<std::size_t>(surface.vertices)));
    }
  }
  for (const auto& [body, surface] : before)
    if (now.count(body) == 0) return fmt::format("the body '{}' is gone", body);
  if (is_same) return {};
  const std::string of = looked_at == vertices ? fmt::format("all {} vertices", vertices)
                                               : fmt::format("{} of {} vertices looked at", looked_at, vertices);
  if (farthest == 0) return fmt::format("a vertex moved, but none of {}", of);
  return fmt::format("the largest move of {} is {} ({})", of, in_words(farthest), where);
}

nlohmann::ordered_json to_json(const GoldenSurface& surface) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(surface.sample.data());
  return {{"vertices", surface.vertices},
          {"hash", surface.hash},
          {"sample", base64(std::span(bytes, surface.sample.size() * sizeof(Vec3f)))}};
}

GoldenSurface surface_of(const nlohmann::json& json) {
  GoldenSurface surface{json.at("vertices").get<std::int64_t>(), json.at("hash").get<std::string>(), {}};
  const std::vector<std::uint8_t> bytes = from_base64(json.at("sample").get<std::string>());
  surface.sample.resize(bytes.size() / sizeof(Vec3f));
  if (!surface.sample.empty())
    std::memcpy(static_cast<void*>(surface.sample.data()), bytes.data(), surface.sample.size() * sizeof(Vec3f));
  return surface;
}

}  // namespace

std::size_t sampled_vertex(std::size_t k, std::size_t vertices) {
  return vertices <= kGoldenSample ? k : k * vertices / kGoldenSample;
}

GoldenGeometry golden_geometry(const ShotRun& run, const std::vector<SkinnedBody>& bodies) {
  GoldenGeometry geometry;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::vector<Vec3>& positions = bodies[b].times.back().positions;
    std::vector<Vec3f> rounded;
    rounded.reserve(positions.size());
    for (const Vec3& p : positions) rounded.push_back(p.cast<float>());
    GoldenSurface surface;
    surface.vertices = static_cast<std::int64_t>(rounded.size());
    surface.hash = KeyHasher("golden surface 1").add(rounded).add(run.loaded(b).surface.triangles).key();
    for (std::size_t k = 0; k < std::min(kGoldenSample, rounded.size()); ++k)
      surface.sample.push_back(rounded[sampled_vertex(k, rounded.size())]);
    geometry[run.settings(b).name] = std::move(surface);
  }
  return geometry;
}

SettingsSnapshot golden_settings(const ShotRun& run) {
  const Shot shot = without_places(run.shot());
  SettingsSnapshot settings{{"shot", to_toml(shot)}, {"unset", to_toml(all_default(shot))}};
  for (const auto& [path, checksum] : snapshot(run)) {
    if (path == "shot") continue;
    const bool is_mesh = path.starts_with("mesh ");
    settings[(is_mesh ? "mesh " : "") + bare_name(is_mesh ? path.substr(5) : path)] = checksum;
  }
  return settings;
}

std::string to_json(const GoldenRecord& record) {
  nlohmann::ordered_json json;
  json["format"] = kRecordFormat;
  for (const auto& [name, value] : record.settings)
    if (name != "unset") json["settings"][name] = value;
  for (const auto& [frame, geometry] : record.frames)
    for (const auto& [body, surface] : geometry) json["frames"][std::to_string(frame)][body] = to_json(surface);
  return json_text(json) + "\n";
}

std::optional<GoldenRecord> read_golden_record(const std::string& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    const auto bytes = read_file(path);
    const auto json = nlohmann::json::parse(bytes.begin(), bytes.end());
    if (json.at("format").get<int>() != kRecordFormat) throw work_error("it has another format");
    GoldenRecord record;
    for (const auto& [name, value] : json.at("settings").items()) record.settings[name] = value.get<std::string>();
    for (const auto& [frame, bodies] : json.at("frames").items())
      for (const auto& [body, surface] : bodies.items()) record.frames[std::stoi(frame)][body] = surface_of(surface);
    return record;
  } catch (const std::exception& problem) {
    throw input_error(
        fmt::format("{}: is no record of golden images: {}.\n  Accepted: what `softreel golden --update` "
                    "wrote. Make it again, or remove it.",
                    path, problem.what()));
  }
}

GoldenCause find_cause(const std::optional<GoldenRecord>& record, int frame, const SettingsSnapshot& settings,
                       const GoldenGeometry& geometry) {
  if (!record || record->frames.count(frame) == 0)
    return {false, "whether simulation or renderer changed is not known: there is no record; --update makes one"};
  const std::string moved = geometry_change(record->frames.at(frame), geometry);
  const std::vector<std::string> fields = changed_fields(record->settings, settings);
  const std::string said = first_of(fields);
  if (!moved.empty())
    return {false, fmt::format("the simulation changed: {}{}", moved,
                               fields.empty() ? "; the shot says the same" : "; the shot changed: " + said)};
  if (!fields.empty()) return {true, "same geometry: the look changed: " + said};
  return {true, "same geometry, same shot: the renderer changed"};
}

}  // namespace softreel
