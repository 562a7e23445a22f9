#include "tool/stages/outputs.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "tool/stages/atomic_file.h"
#include "tool/stages/byte_hasher.h"
#include "tool/stages/file_lock.h"
#include "tool/stages/json_text.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

constexpr int kManifestFormat = 2;

std::string name_of(const std::string& path) {
  return fs::path(path).filename().string();
}

std::string settings_id_of(const SettingsSnapshot& settings) {
  KeyHasher key("settings");
  for (const auto& [field, value] : settings) key.add(field).add(value);
  return key.key();
}

}  // namespace

Outputs::Outputs(std::string folder, std::string shot_name, const Log& log)
    : folder_(std::move(folder)), shot_name_(std::move(shot_name)), log_(log) {
  require_utf8(shot_name_, "the name of the shot");
  require_utf8(folder_, "the output folder");
  revision_ = stored_revision();
  contents_ = read();
}

std::string Outputs::lock_path() const {
  return (fs::path(folder_) / fmt::format(".{}.manifest.lock", shot_name_)).string();
}

std::string Outputs::stored_revision() const {
  std::string revision;
  std::getline(std::ifstream(lock_path()), revision);
  return revision;
}

std::string Outputs::manifest_path() const {
  return (fs::path(folder_) / (shot_name_ + ".manifest.json")).string();
}

Outputs::Contents Outputs::read() const {
  Contents contents;
  if (!fs::exists(manifest_path())) return contents;
  try {
    const auto bytes = read_file(manifest_path());
    const auto json = nlohmann::json::parse(bytes.begin(), bytes.end());
    if (const int format = json.at("format").get<int>(); format != kManifestFormat) {
      log_.warn(fmt::format("{}: is of format {}, this softreel reads format {}; its files are made again.",
                            manifest_path(), format, kManifestFormat));
      return contents;
    }
    for (const auto& [name, entry] : json.at("files").items())
      contents.entries[name] = {entry.at("key").get<std::string>(), entry.at("checksum").get<std::string>(),
                                entry.at("seconds").get<double>(), entry.at("settings").get<std::string>()};
    contents.settings = json.at("settings").get<std::map<std::string, SettingsSnapshot>>();
    contents.simulated = json.at("simulated").get<std::string>();
  } catch (const std::exception& problem) {
    contents = {};
    log_.warn(fmt::format("{}: damaged ({}); its files are made again.", manifest_path(), problem.what()));
  }
  return contents;
}

void Outputs::set_settings(const SettingsSnapshot& settings) {
  // Now rather than when the first file is made: the manifest holds them as they are.
  for (const auto& [field, value] : settings) {
    require_utf8(field, "a path that the shot reads");
    require_utf8(value, "a text or a path of the shot");
  }
  settings_ = settings;
  settings_id_ = settings_id_of(settings);
}

std::string Outputs::frame_path(int frame, const std::string& extension) const {
  return (fs::path(folder_) / fmt::format("{}.{:04}.{}", shot_name_, frame, extension)).string();
}

std::string Outputs::path(const std::string& extension) const {
  return (fs::path(folder_) / fmt::format("{}.{}", shot_name_, extension)).string();
}

std::optional<OutputEntry> Outputs::entry(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  const auto found = contents_.entries.find(name_of(path));
  if (found == contents_.entries.end()) return std::nullopt;
  return found->second;
}

std::vector<std::string> Outputs::paths() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> paths;
  for (const auto& [name, entry] : contents_.entries) paths.push_back((fs::path(folder_) / name).string());
  return paths;
}

std::optional<SettingsSnapshot> Outputs::settings(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = contents_.settings.find(id);
  if (found == contents_.settings.end()) return std::nullopt;
  return found->second;
}

std::string Outputs::simulated_settings() const {
  const std::lock_guard lock(mutex_);
  return contents_.simulated;
}

OutputState Outputs::claimed_state(const std::string& path, const StageKey& key) const {
  return claimed_state(path, key, entry(path));
}

OutputState Outputs::claimed_state(const std::string& path, const StageKey& key,
                                   const std::optional<OutputEntry>& known) {
  std::error_code none;
  if (!fs::exists(path, none)) return OutputState::Missing;
  if (!known) return OutputState::Unknown;
  return known->key == key ? OutputState::Done : OutputState::Stale;
}

OutputState Outputs::state(const std::string& path, const StageKey& key) const {
  const std::optional<OutputEntry> known = entry(path);  // once: other processes may change it while the file is read
  const OutputState claimed = claimed_state(path, key, known);
  if (claimed != OutputState::Done) return claimed;
  try {
    return hash_file(path) == known->checksum ? OutputState::Done : OutputState::Damaged;
  } catch (const Error&) {
    return OutputState::Damaged;  // a folder of this name, say
  }
}

bool Outputs::is_done(const std::string& path, const StageKey& key) const {
  const OutputState found = state(path, key);
  if (found == OutputState::Damaged)
    log_.warn(fmt::format("{}: damaged or changed since it was made; it is made again.", path));
  return found == OutputState::Done;
}

bool Outputs::insert(const std::string& path, const OutputEntry& entry, const std::function<bool()>& give_name) {
  return update([&](Contents& contents) {
    if (!give_name()) return false;
    contents.entries[name_of(path)] = entry;
    return true;
  });
}

void Outputs::write(const std::string& path, const StageKey& key, std::span<const std::uint8_t> bytes, double seconds) {
  AtomicFile file(path);
  file.write(bytes);
  commit(file, key, hash_bytes(bytes), seconds);
}

void Outputs::link(const std::string& path, const StageKey& key, const std::string& stored_path,
                   std::span<const std::uint8_t> bytes, double seconds) {
  const OutputEntry entry{key, hash_bytes(bytes), seconds, settings_id_};
  if (!insert(path, entry, [&] { return link_file(stored_path, path); })) write(path, key, bytes, seconds);
}

void Outputs::commit(AtomicFile& file, const StageKey& key, const StageKey& checksum, double seconds) {
  file.flush();  // before others have to wait for it
  insert(file.path(), {key, checksum, seconds, settings_id_}, [&] {
    file.commit(AtomicFile::Flush::Later);
    return true;
  });
}

int Outputs::remove_if(const std::vector<std::string>& paths,
                       const std::function<bool(const std::string& path)>& is_outdated) {
  if (std::none_of(paths.begin(), paths.end(), is_outdated)) return 0;  // as a rule: the manifest stays as it is
  int removed = 0;
  update([&](Contents& contents) {
    for (const std::string& path : paths) {
      if (!is_outdated(path)) continue;
      std::error_code failed;
      fs::remove(path, failed);
      if (failed) throw work_error(fmt::format("{}: cannot be removed: {}.", path, failed.message()));
      contents.entries.erase(name_of(path));
      ++removed;
    }
    return removed > 0;
  });
  return removed;
}

int Outputs::remove_outdated(const std::map<std::string, StageKey>& keys) {
  std::vector<std::string> paths;
  for (const auto& [path, key] : keys) paths.push_back(path);
  return remove_if(paths, [&](const std::string& path) {
    const OutputState state = claimed_state(path, keys.at(path));
    return state == OutputState::Stale || state == OutputState::Unknown;
  });
}

void Outputs::read_again() {
  const std::lock_guard lock(mutex_);
  contents_ = read();
  revision_ = "";  // of which it is, is not known: the next change reads it under the lock
}

void Outputs::note_simulation() {
  if (simulated_settings() == settings_id_) return;
  update([&](Contents& contents) {
    contents.simulated = settings_id_;
    return true;
  });
}

bool Outputs::update(const std::function<bool(Contents&)>& change) {
  const std::lock_guard in_process(mutex_);
  make_folder(folder_);
  // The lock file holds a random text that each writer replaces: whoever finds another one reads the manifest again.
  const FileLock lock = FileLock::take(lock_path());
  if (revision_.empty() || stored_revision() != revision_) contents_ = read();
  if (!change(contents_)) return false;
  if (!settings_id_.empty()) contents_.settings[settings_id_] = settings_;
  std::set<std::string> used{contents_.simulated, settings_id_};
  for (const auto& [name, entry] : contents_.entries) used.insert(entry.settings);
  std::erase_if(contents_.settings, [&](const auto& item) { return used.count(item.first) == 0; });
  // Whoever reads now, or after a kill between the two, sees a revision that nobody's contents are of.
  store_revision("");
  write_manifest();
  revision_ = fmt::format("{:08x}{:08x}", std::random_device{}(), std::random_device{}());
  store_revision(revision_);
  return true;
}

void Outputs::store_revision(const std::string& revision) const {
  std::ofstream(lock_path(), std::ios::trunc) << revision << "\n";  // if that fails, the manifest is read once more
}

void Outputs::write_manifest() const {
  nlohmann::json files = nlohmann::json::object();
  for (const auto& [name, entry] : contents_.entries)
    files[name] = {
        {"key", entry.key}, {"checksum", entry.checksum}, {"seconds", entry.seconds}, {"settings", entry.settings}};
  const nlohmann::json manifest = {{"format", kManifestFormat},
                                   {"shot", shot_name_},
                                   {"files", files},
                                   {"settings", contents_.settings},
                                   {"simulated", contents_.simulated}};
  write_file(manifest_path(), manifest.dump(1) + "\n");
}

}  // namespace softreel
