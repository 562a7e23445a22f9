#include "tool/stages/settings_snapshot.h"

#include <charconv>
#include <filesystem>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/mesh/readers/mesh_source.h"
#include "tool/bodies/weight_maps.h"
#include "tool/cache/atomic_file.h"
#include "tool/shot/shot_load.h"

namespace softreel {
namespace {

/// The entry of a snapshot that holds the shot; the others are paths of files.
constexpr const char* kShotEntry = "shot";
constexpr std::string_view kMeshPrefix = "mesh ";

std::string absolute(const std::string& path) {
  std::error_code none;
  const auto real = std::filesystem::weakly_canonical(path, none);
  return none ? path : real.string();
}

std::string checksum_of(const std::string& path) {
  try {
    return hash_bytes(read_file(path));
  } catch (const Error&) {
    return "unreadable";
  }
}

/// "%20" in the address of a file is a blank.
std::string decoded(const std::string& address) {
  std::string text;
  for (std::size_t i = 0; i < address.size(); ++i) {
    unsigned char byte = 0;
    const char* const digits = address.data() + i + 1;
    const bool is_code =
        address[i] == '%' && i + 2 < address.size() && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
    text += is_code ? static_cast<char>(byte) : address[i];
    if (is_code) i += 2;
  }
  return text;
}

/// The files with the numbers of a glTF scene, as it names them; none of one that cannot be read.
std::vector<std::string> buffer_files(const std::string& path) {
  std::vector<std::string> files;
  try {
    const nlohmann::json scene = nlohmann::json::parse(read_file(path));
    for (const nlohmann::json& buffer : scene.at("buffers"))
      if (const std::string address = buffer.value("uri", ""); !address.empty() && !address.starts_with("data:"))
        files.push_back((std::filesystem::path(path).parent_path() / decoded(address)).string());
  } catch (const std::exception&) {
    files.clear();
  }
  return files;
}

/// Of a file that constraints read, and of those that a glTF scene keeps its motion in.
std::string constraint_checksum(const std::string& path) {
  const std::string own = checksum_of(path);
  const std::vector<std::string> buffers =
      detail::lower_extension(path) == ".gltf" ? buffer_files(path) : std::vector<std::string>();
  if (buffers.empty()) return own;
  KeyHasher key("scene and buffers");
  key.add(own);
  for (const std::string& file : buffers) key.add(checksum_of(file));
  return key.key();
}

/// Steps from the root of a document to a place in it.
struct Step {
  std::string key;        ///< of a table, or
  std::size_t index = 0;  ///< of an array, where key is empty
};
using Steps = std::vector<Step>;

std::string path_of(const Steps& steps) {
  std::string path;
  for (const Step& step : steps)
    path += step.key.empty() ? fmt::format("[{}]", step.index) : (path.empty() ? "" : ".") + key_text(step.key);
  return path;
}

/// The document with `value` at a place; without the place if there is no value.
TomlValue replaced(TomlValue document, const Steps& steps, const TomlValue* value) {
  TomlValue* at = &document;
  for (std::size_t s = 0; s + 1 < steps.size(); ++s)
    at = steps[s].key.empty() ? &(*at->array())[steps[s].index] : at->find(steps[s].key);
  const Step& last = steps.back();
  if (last.key.empty()) {
    (*at->array())[last.index] = *value;  // arrays of other lengths are compared as a whole
  } else if (value == nullptr) {
    std::erase_if(*at->table(), [&](const TomlEntry& entry) { return entry.key == last.key; });
  } else if (TomlValue* present = at->find(last.key)) {
    *present = *value;
  } else {
    at->table()->push_back(toml_entry(last.key, *value));
  }
  return document;
}

/// Visits every innermost place where two documents differ; null: it is not there.
class Comparison {
 public:
  using Visit = std::function<void(const Steps&, const TomlValue*, const TomlValue*)>;
  explicit Comparison(Visit visit) : visit_(std::move(visit)) {}

  void compare(const TomlValue& before, const TomlValue& after) {
    if (before.table() != nullptr && after.table() != nullptr) {
      for (const TomlEntry& entry : *after.table()) at({entry.key}, before.find(entry.key), &entry.value);
      for (const TomlEntry& entry : *before.table())
        if (after.find(entry.key) == nullptr) at({entry.key}, &entry.value, nullptr);
    } else if (is_list_of_tables(before) && is_list_of_tables(after) &&
               before.array()->size() == after.array()->size()) {
      for (std::size_t i = 0; i < after.array()->size(); ++i) at({"", i}, &(*before.array())[i], &(*after.array())[i]);
    } else if (to_text(before) != to_text(after)) {
      visit_(steps_, &before, &after);
    }
  }

 private:
  static bool is_list_of_tables(const TomlValue& value) {
    return value.array() != nullptr && !value.array()->empty() && value.array()->front().table() != nullptr;
  }

  void at(Step step, const TomlValue* before, const TomlValue* after) {
    steps_.push_back(std::move(step));
    if (before != nullptr && after != nullptr)
      compare(*before, *after);
    else
      visit_(steps_, before, after);
    steps_.pop_back();
  }

  Visit visit_;
  Steps steps_;
};

TomlValue document_of(const SettingsSnapshot& snapshot) {
  const auto found = snapshot.find(kShotEntry);
  return parse_toml(found == snapshot.end() ? "" : found->second, "the manifest's settings");
}

}  // namespace

namespace {

/// Colours shape no body, so that its key leaves them out; pictures change with them.
StageKey mesh_entry(const LoadedBody& loaded) {
  if (loaded.surface.colors.empty()) return loaded.file_key;
  return KeyHasher("painted mesh").add(loaded.file_key).add(loaded.surface.colors).key();
}

}  // namespace

SettingsSnapshot snapshot(const ShotRun& run) {
  Shot with_paths = run.shot();
  SettingsSnapshot snapshot;
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    BodySettings& body = with_paths.bodies[b];
    body.mesh = absolute(body.mesh);
    snapshot[std::string(kMeshPrefix) + body.mesh] = mesh_entry(run.loaded(b));
    for (std::string* path : constraint_files(body, with_paths.glues)) {
      *path = absolute(*path);
      snapshot[std::string(kMeshPrefix) + *path] = constraint_checksum(*path);
    }
    if (body.tetrahedra.empty()) continue;
    body.tetrahedra = absolute(body.tetrahedra);
    snapshot[std::string(kMeshPrefix) + body.tetrahedra] = run.loaded(b).given_key;
  }
  if (!with_paths.environment_image.empty()) {
    with_paths.environment_image = absolute(with_paths.environment_image);
    snapshot[with_paths.environment_image] = checksum_of(with_paths.environment_image);
  }
  for (auto& [name, material] : with_paths.materials)
    for (std::string* path : material.textures.paths())
      if (!path->empty()) {
        *path = absolute(*path);
        snapshot[*path] = checksum_of(*path);
      }
  snapshot[kShotEntry] = to_toml(with_paths);
  return snapshot;
}

namespace {

/// What a snapshot knows of the file that a field names; null if the field names none.
const StageKey* content_of(const TomlValue* field, const SettingsSnapshot& snapshot) {
  if (field == nullptr || field->text() == nullptr) return nullptr;
  auto found = snapshot.find(std::string(kMeshPrefix) + *field->text());
  if (found == snapshot.end()) found = snapshot.find(*field->text());
  return found == snapshot.end() || found->first == kShotEntry ? nullptr : &found->second;
}

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace

std::vector<FieldChange> find_changes(const SettingsSnapshot& before, const SettingsSnapshot& after) {
  std::vector<FieldChange> changes;
  const TomlValue old_document = document_of(before), new_document = document_of(after);
  Comparison comparison([&](const Steps& steps, const TomlValue* was, const TomlValue* is) {
    if (const StageKey* old = content_of(was, before), *now = content_of(is, after); old != nullptr && now != nullptr) {
      if (*old == *now) return;  // the file lies elsewhere, which changes nothing
      if (file_name(*was->text()) == file_name(*is->text())) {
        const bool is_mesh = after.contains(std::string(kMeshPrefix) + *is->text());
        changes.push_back({"content of " + *is->text(), is_mesh, *old, *now, std::nullopt});
        return;
      }
    }
    changes.push_back({path_of(steps), false, was ? to_short_text(*was) : "", is ? to_short_text(*is) : "",
                       replaced(new_document, steps, was)});
  });
  comparison.compare(old_document, new_document);
  for (const auto& [path, checksum] : after) {
    const auto was = before.find(path);
    if (path == kShotEntry || was == before.end() || was->second == checksum) continue;
    const bool is_mesh = path.starts_with(kMeshPrefix);
    changes.push_back({"content of " + (is_mesh ? path.substr(kMeshPrefix.size()) : path), is_mesh, was->second,
                       checksum, std::nullopt});
  }
  return changes;
}

}  // namespace softreel
