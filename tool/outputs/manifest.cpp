#include "tool/outputs/manifest.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tool/cache/atomic_file.h"
#include "tool/cache/file_lock.h"

namespace softreel {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

/// 2 had no journal: one that reads it alone would lose what was not folded in yet.
constexpr int kManifestFormat = 3, kFormatWithoutJournal = 2;

/// Of a fixed length, and used once.
std::string random_text() {
  return fmt::format("{:08x}{:08x}", std::random_device{}(), std::random_device{}());
}

/// None if there is no such file.
std::optional<std::string> text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

Json to_json(const ManifestChange& change) {
  Json files = Json::object();
  for (const auto& [name, entry] : change.files) {
    files[name] = nullptr;
    if (entry)
      files[name] = {{"key", entry->key},
                     {"checksum", entry->checksum},
                     {"seconds", entry->seconds},
                     {"settings", entry->settings}};
  }
  Json json{{"files", std::move(files)}, {"settings", change.settings}};
  if (change.simulated) json["simulated"] = *change.simulated;
  return json;
}

/// Of a line of the journal, or of a whole manifest, which is a change of nothing. Throws for anything else.
ManifestChange change_in(const Json& json) {
  ManifestChange change;
  for (const auto& [name, entry] : json.at("files").items()) {
    change.files[name] = std::nullopt;
    if (!entry.is_null())
      change.files[name] = OutputEntry{entry.at("key").get<std::string>(), entry.at("checksum").get<std::string>(),
                                       entry.at("seconds").get<double>(), entry.at("settings").get<std::string>()};
  }
  change.settings = json.at("settings").get<std::map<std::string, SettingsSnapshot>>();
  if (json.contains("simulated")) change.simulated = json.at("simulated").get<std::string>();
  return change;
}

void apply(const ManifestChange& change, ManifestContents& contents) {
  for (const auto& [name, entry] : change.files) {
    if (entry)
      contents.files[name] = *entry;
    else
      contents.files.erase(name);
  }
  for (const auto& [id, settings] : change.settings) contents.settings[id] = settings;
  if (change.simulated) contents.simulated = *change.simulated;
}

}  // namespace

Manifest::Manifest(const std::string& folder, const std::string& shot_name, const Log& log)
    : shot_name_(shot_name),
      path_((fs::path(folder) / (shot_name + ".manifest.json")).string()),
      journal_path_((fs::path(folder) / fmt::format(".{}.manifest.journal", shot_name)).string()),
      lock_path_((fs::path(folder) / fmt::format(".{}.manifest.lock", shot_name)).string()),
      log_(log) {}

std::string Manifest::stored_revision() const {
  std::string revision;
  std::getline(std::ifstream(lock_path_), revision);
  return revision;
}

void Manifest::store_revision(const std::string& revision) const {
  std::ofstream(lock_path_, std::ios::trunc) << revision << "\n";  // if that fails, all is read once more
}

std::string Manifest::header() const {
  return fmt::format("{{\"journal\":\"{}\"}}\n", journal_);
}

void Manifest::read() {
  // Before the rest: what is written from then on has another one.
  revision_ = stored_revision();
  std::optional<std::string> manifest = text_of(path_);
  while (true) {
    const std::string journal = text_of(journal_path_).value_or("");
    std::optional<std::string> now = text_of(path_);
    // Another manifest came between the two: it holds what the journal of the first held.
    if (now != manifest) {
      manifest = std::move(now);
      continue;
    }
    take(manifest, journal);
    return;
  }
}

void Manifest::take(const std::optional<std::string>& manifest, const std::string& journal) {
  contents_ = {};
  journal_.clear();
  manifest_size_ = manifest ? manifest->size() : 0;
  journal_size_ = 0;
  if (!manifest || !take_manifest(*manifest)) return;
  if (journal_.empty() || !journal.starts_with(header())) return;
  journal_size_ = header().size();
  journal_size_ += take_lines(journal.substr(journal_size_));
}

/// False if it cannot be used, which is said.
bool Manifest::take_manifest(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    if (const int format = json.at("format").get<int>(); format != kManifestFormat && format != kFormatWithoutJournal) {
      log_.warn(fmt::format("{}: is of format {}, this softreel reads format {}; its files are made again.", path_,
                            format, kManifestFormat));
      return false;
    }
    apply(change_in(json), contents_);
    journal_ = json.value("journal", "");
    return true;
  } catch (const std::exception& problem) {
    contents_ = {};
    log_.warn(fmt::format("{}: damaged ({}); its files are made again.", path_, problem.what()));
    return false;
  }
}

/// Takes the whole lines of a text, and returns how many bytes they are. A line that is none was begun by a process
/// that was killed, or on a full disk: what it says was never said to be done, and its files are made again.
std::size_t Manifest::take_lines(const std::string& text) {
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    try {
      apply(change_in(Json::parse(text.begin() + static_cast<std::ptrdiff_t>(begin),
                                  text.begin() + static_cast<std::ptrdiff_t>(end))),
            contents_);
    } catch (const Json::exception&) {
      continue;
    }
  }
  return begin;
}

/// What others added to the journal that contents_ holds the beginning of. False if there is nothing of the kind.
bool Manifest::take_news() {
  std::ifstream in(journal_path_, std::ios::binary);
  std::string begun(header().size(), '\0');
  if (!in.read(begun.data(), static_cast<std::streamsize>(begun.size())) || begun != header()) return false;
  const std::size_t known = std::max(journal_size_, begun.size());
  in.seekg(static_cast<std::streamoff>(known));
  const std::size_t taken = take_lines({std::istreambuf_iterator<char>(in), {}});
  if (taken > 0) journal_size_ = known + taken;
  return taken > 0;
}

/// Under the lock. The lock file holds a text that each writer replaces: whoever finds another one reads. It starts
/// with the journal's name, for the end of one journal is news only while the manifest is the one that it continues.
void Manifest::catch_up() {
  const std::string revision = stored_revision();
  if (!revision_.empty() && revision == revision_) return;
  if (!journal_.empty() && revision.starts_with(journal_) && take_news())
    revision_ = revision;
  else
    read();
}

void Manifest::locked(const std::function<void()>& work) {
  const FileLock lock = FileLock::take(lock_path_);
  catch_up();
  try {
    work();
  } catch (...) {
    // contents_ may hold what could not be written: all is read again, not the journal's end alone.
    revision_.clear();
    journal_.clear();
    throw;
  }
}

/// Whoever reads while it writes, or after a kill, sees a revision that nobody's contents are of.
void Manifest::write(const std::function<void()>& how) {
  store_revision("");
  how();
  revision_ = journal_ + random_text();
  store_revision(revision_);
}

bool Manifest::update(const Change& change) {
  bool is_changed = false;
  locked([&] {
    const std::optional<ManifestChange> made = change(contents_);
    if (!made) return;
    const std::string line = to_json(*made).dump() + "\n";
    apply(*made, contents_);
    const std::string text = journal_size_ == 0 ? header() + line : line;
    write([&] {
      if (journal_.empty() || journal_size_ + text.size() > manifest_size_)
        write_whole();
      else
        journal_size_ = append_to_file(journal_path_, journal_size_, text);
    });
    is_changed = true;
  });
  return is_changed;
}

void Manifest::fold() {
  std::error_code none;
  if (!fs::exists(journal_path_, none)) return;
  locked([&] {
    if (fs::exists(journal_path_, none)) write([&] { write_whole(); });
  });
}

void Manifest::forget_unused_settings() {
  std::set<std::string> used{contents_.simulated};
  for (const auto& [name, entry] : contents_.files) used.insert(entry.settings);
  std::erase_if(contents_.settings, [&](const auto& item) { return used.count(item.first) == 0; });
}

/// A death before the journal is removed leaves one of another name, which nobody reads.
void Manifest::write_whole() {
  forget_unused_settings();
  const std::string journal = random_text();
  ManifestChange all{{}, contents_.settings, contents_.simulated};
  for (const auto& [name, entry] : contents_.files) all.files[name] = entry;
  Json json = to_json(all);
  json["format"] = kManifestFormat;
  json["shot"] = shot_name_;
  json["journal"] = journal;
  const std::string text = json.dump(1) + "\n";
  write_file(path_, text);
  std::error_code ignored;
  fs::remove(journal_path_, ignored);
  journal_ = journal;
  manifest_size_ = text.size();
  journal_size_ = 0;
}

}  // namespace softreel
