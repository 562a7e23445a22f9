#include "tool/outputs/outputs.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/cache/atomic_file.h"
#include "tool/cache/byte_hasher.h"
#include "tool/cache/json_text.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

std::string name_of(const std::string& path) {
  return fs::path(path).filename().string();
}

/// The number that ends a text after a point: of "DIR/SHOT.0012", 12.
std::optional<int> number_at_end(const std::string& text) {
  const std::size_t point = text.rfind('.');
  if (point == std::string::npos) return std::nullopt;
  const char* const end = text.data() + text.size();
  int number = 0;
  const auto [stopped, code] = std::from_chars(text.data() + point + 1, end, number);
  if (code != std::errc{} || stopped != end) return std::nullopt;
  return number;
}

/// Whole, without links but for one of the file itself: that is what a new file of this name would take the place of.
std::string place_of(const std::string& path) {
  const fs::path whole = fs::absolute(path);
  std::error_code none;
  return (fs::weakly_canonical(whole.parent_path(), none) / whole.filename()).string();
}

std::string settings_id_of(const SettingsSnapshot& settings) {
  KeyHasher key("settings");
  for (const auto& [field, value] : settings) key.add(field).add(value);
  return key.key();
}

}  // namespace

Outputs::Outputs(std::string folder, std::string shot_name, const Log& log)
    : folder_(std::move(folder)), shot_name_(std::move(shot_name)), log_(log), manifest_(folder_, shot_name_, log) {
  require_utf8(shot_name_, "the name of the shot");
  require_utf8(folder_, "the output folder");
  manifest_.read();
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

void Outputs::protect(const std::vector<std::string>& inputs) {
  for (const std::string& path : inputs) {
    constexpr int kMostLinks = 40;  // as the system follows
    fs::path at = path;
    std::error_code none;
    for (int link = 0; link <= kMostLinks; ++link) {
      protected_.insert(place_of(at.string()));
      if (!fs::is_symlink(at, none)) break;
      const fs::path to = fs::read_symlink(at, none);
      at = to.is_absolute() ? to : at.parent_path() / to;
    }
  }
}

void Outputs::require_free(const std::string& path) const {
  if (!protected_.contains(place_of(path))) return;
  throw input_error(
      fmt::format("{}: the shot reads this file, and a result would take its place.\n"
                  "  Accepted: results of other names than what the shot is made of. Give another output folder "
                  "(--output DIR) or shot.name, or move the file and say so in the shot.",
                  path));
}

std::string Outputs::frame_path(int frame, const std::string& extension) const {
  return (fs::path(folder_) / fmt::format("{}.{:04}.{}", shot_name_, frame, extension)).string();
}

std::string Outputs::path(const std::string& extension) const {
  return (fs::path(folder_) / fmt::format("{}.{}", shot_name_, extension)).string();
}

std::optional<OutputEntry> Outputs::entry(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  const auto found = manifest_.contents().files.find(name_of(path));
  if (found == manifest_.contents().files.end()) return std::nullopt;
  return found->second;
}

std::vector<std::string> Outputs::paths() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> paths;
  for (const auto& [name, entry] : manifest_.contents().files) paths.push_back((fs::path(folder_) / name).string());
  return paths;
}

std::optional<SettingsSnapshot> Outputs::settings(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = manifest_.contents().settings.find(id);
  if (found == manifest_.contents().settings.end()) return std::nullopt;
  return found->second;
}

std::string Outputs::simulated_settings() const {
  const std::lock_guard lock(mutex_);
  return manifest_.contents().simulated;
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
  require_free(path);
  return update([&](const ManifestContents&) -> std::optional<ManifestChange> {
    if (!give_name()) return std::nullopt;
    return ManifestChange{{{name_of(path), entry}}, {}, {}};
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
  update([&](const ManifestContents&) -> std::optional<ManifestChange> {
    ManifestChange change;
    for (const std::string& path : paths) {
      if (!is_outdated(path)) continue;
      require_free(path);
      std::error_code failed;
      fs::remove(path, failed);
      if (failed) throw work_error(fmt::format("{}: cannot be removed: {}.", path, failed.message()));
      change.files[name_of(path)] = std::nullopt;
      ++removed;
    }
    if (removed == 0) return std::nullopt;
    return change;
  });
  return removed;
}

bool Outputs::is_outdated(const std::string& path, const StageKey& key) const {
  const OutputState state = claimed_state(path, key);
  return state == OutputState::Stale || state == OutputState::Unknown;
}

bool Outputs::has_outdated(const std::map<std::string, StageKey>& keys) const {
  return std::any_of(keys.begin(), keys.end(), [&](const auto& one) { return is_outdated(one.first, one.second); });
}

int Outputs::remove_outdated(const std::map<std::string, StageKey>& keys) {
  std::vector<std::string> paths;
  for (const auto& [path, key] : keys) paths.push_back(path);
  return remove_if(paths, [&](const std::string& path) { return is_outdated(path, keys.at(path)); });
}

std::vector<std::string> Outputs::pictures_outside(int first, int last) const {
  std::vector<std::string> outside;
  for (const std::string& path : paths())
    for (const char* extension : {"png", "exr"}) {
      const std::optional<int> frame = number_at_end(fs::path(path).replace_extension().string());
      // By the whole name too: other files may have a number at this place.
      if (frame && (*frame < first || *frame > last) && path == frame_path(*frame, extension)) outside.push_back(path);
    }
  return outside;
}

int Outputs::remove_pictures_outside(int first, int last) {
  return remove_if(pictures_outside(first, last), [&](const std::string& path) { return entry(path).has_value(); });
}

void Outputs::read_again() {
  const std::lock_guard lock(mutex_);
  manifest_.read();
}

void Outputs::fold() {
  const std::lock_guard lock(mutex_);
  manifest_.fold();
}

void Outputs::note_simulation() {
  if (simulated_settings() == settings_id_) return;
  update([&](const ManifestContents&) { return ManifestChange{{}, {}, settings_id_}; });
}

bool Outputs::update(const Manifest::Change& change) {
  const std::lock_guard in_process(mutex_);
  make_folder(folder_);
  return manifest_.update([&](const ManifestContents& contents) {
    std::optional<ManifestChange> made = change(contents);
    const bool is_new = !settings_id_.empty() && !contents.settings.contains(settings_id_);
    if (made && is_new) made->settings[settings_id_] = settings_;
    return made;
  });
}

}  // namespace softreel
