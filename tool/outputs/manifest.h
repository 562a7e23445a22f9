/// SHOT.manifest.json, what is known of the files in an output folder, and the journal of what changed since it was
/// written.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "core/base/log.h"
#include "tool/cache/key.h"

namespace softreel {

/// What the manifest says of one file.
struct OutputEntry {
  StageKey key;  ///< of everything that made it
  std::string checksum;
  double seconds = 0;    ///< what making it took
  std::string settings;  ///< id of the settings it was made with, for saying why it is stale
};

/// The settings of a shot as one text per field, with the checksums of the files it reads.
using SettingsSnapshot = std::map<std::string, std::string>;

struct ManifestContents {
  std::map<std::string, OutputEntry> files;  ///< by file name
  std::map<std::string, SettingsSnapshot> settings;
  std::string simulated;  ///< id of settings; empty: none
};

/// Made twice it is the same as made once: a reader may have seen a part of the journal already.
struct ManifestChange {
  std::map<std::string, std::optional<OutputEntry>> files;  ///< by file name; nothing: there is none any more
  std::map<std::string, SettingsSnapshot> settings;         ///< new ones
  std::optional<std::string> simulated;
};

/// The manifest with its journal, .SHOT.manifest.journal: a line for each change, so that n files cost n lines. Both
/// are written under one lock. The manifest is written whole, and the journal begun anew, when that would become the
/// longer of the two, and by `fold`; the total stays linear. Each manifest names the one journal that continues it: one
/// that a killed process left beside a newer manifest, which holds all of it, is of another name and not read. Not
/// thread-safe.
class Manifest {
 public:
  /// Knows nothing before `read`. log: kept by reference.
  Manifest(const std::string& folder, const std::string& shot_name, const Log& log);

  const ManifestContents& contents() const { return contents_; }

  /// Takes what is there now, without the lock. A damaged manifest is said, and counts as empty.
  void read();

  using Change = std::function<std::optional<ManifestChange>(const ManifestContents&)>;
  /// Under the lock: takes what others changed, asks `change` what to change (nothing: all stays as it is), and writes
  /// that. False if it was nothing. Throws work_error; then the change counts as not made.
  bool update(const Change& change);

  /// Writes the manifest whole if there is a journal. Throws work_error.
  void fold();

 private:
  void locked(const std::function<void()>& work);
  void write(const std::function<void()>& how);
  void take(const std::optional<std::string>& manifest, const std::string& journal);
  bool take_manifest(const std::string& text);
  std::size_t take_lines(const std::string& text);
  bool take_news();
  void catch_up();
  std::string header() const;
  void forget_unused_settings();
  void write_whole();
  std::string stored_revision() const;
  void store_revision(const std::string& revision) const;

  std::string shot_name_, path_, journal_path_, lock_path_;
  const Log& log_;
  ManifestContents contents_;
  std::string journal_;            ///< the one that continues the manifest; empty: it must be written whole
  std::size_t manifest_size_ = 0;  ///< bytes
  std::size_t journal_size_ = 0;   ///< bytes that contents_ holds, whole lines; 0: none was begun
  std::string revision_;           ///< of what contents_ holds; empty: not known
};

}  // namespace softreel
