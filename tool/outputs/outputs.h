/// The files a run leaves in its output folder, and the manifest, which knows their keys and checksums.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "tool/cache/key.h"
#include "tool/outputs/manifest.h"

namespace softreel {

class AtomicFile;

enum class OutputState { Missing, Unknown, Stale, Damaged, Done };

/// One output folder of one shot. A file counts as done only if the manifest has its key and its bytes have the
/// manifest's checksum. The entry is written with each file, beside what other processes wrote meanwhile; while a file
/// gets its name and its entry, no other process changes or removes either. Thread-safe.
class Outputs {
 public:
  /// Reads the manifest if there is one; a damaged one is said, and all files count as unknown. Throws input_error for
  /// names that are no UTF-8.
  Outputs(std::string folder, std::string shot_name, const Log& log);

  /// "DIR/SHOT.####.EXTENSION"
  std::string frame_path(int frame, const std::string& extension) const;
  /// "DIR/SHOT.EXTENSION"
  std::string path(const std::string& extension) const;
  const std::string& folder() const { return folder_; }
  const std::string& shot_name() const { return shot_name_; }

  /// What files written from now on are made with. Throws input_error for what is no UTF-8.
  void set_settings(const SettingsSnapshot& settings);

  /// Files of these paths, and those that links there lead to, are neither replaced nor removed: whoever tries gets an
  /// input_error.
  void protect(const std::vector<std::string>& inputs);
  /// Throws that for a path of theirs.
  void require_free(const std::string& path) const;

  /// Reads the file to verify it.
  OutputState state(const std::string& path, const StageKey& key) const;
  /// The same without reading: Done may be damaged.
  OutputState claimed_state(const std::string& path, const StageKey& key) const;
  /// True if the file is there, whole, and made from this key; a damaged one is said.
  bool is_done(const std::string& path, const StageKey& key) const;
  std::optional<OutputEntry> entry(const std::string& path) const;
  /// Of all files in the manifest.
  std::vector<std::string> paths() const;
  std::optional<SettingsSnapshot> settings(const std::string& id) const;

  /// Writes the file and its entry. Throws work_error.
  void write(const std::string& path, const StageKey& key, std::span<const std::uint8_t> bytes, double seconds);
  /// Gives a stored file this name too (a copy where links do not reach), and writes its entry.
  void link(const std::string& path, const StageKey& key, const std::string& stored_path,
            std::span<const std::uint8_t> bytes, double seconds);
  /// Commits a file that was written elsewhere, and writes its entry. checksum: of its bytes.
  void commit(AtomicFile& file, const StageKey& key, const StageKey& checksum, double seconds);
  /// Removes the files, and their entries, of which `is_outdated` says so: by what was read before and by what the
  /// manifest says now, whatever other processes make meanwhile. It may ask this object, not change it. Returns how
  /// many.
  int remove_if(const std::vector<std::string>& paths, const std::function<bool(const std::string& path)>& is_outdated);

  /// Removes what is under these paths and not of these keys: files of an older shot, and files that nobody knows.
  /// Returns how many.
  int remove_outdated(const std::map<std::string, StageKey>& keys);
  /// Whether that would remove any.
  bool has_outdated(const std::map<std::string, StageKey>& keys) const;

  /// The known pictures "DIR/SHOT.####.png" and ".exr" whose frames are not from `first` to `last`: of a shot that was
  /// longer, or began elsewhere.
  std::vector<std::string> pictures_outside(int first, int last) const;
  /// Removes these. Returns how many.
  int remove_pictures_outside(int first, int last);

  /// Takes what other processes have entered in the manifest.
  void read_again();
  /// Writes the manifest whole, with what was entered beside it until now. Throws work_error.
  void fold();

  /// Last simulation of the shot in this folder: the id of its settings, empty if there was none.
  std::string simulated_settings() const;
  void note_simulation();

 private:
  static OutputState claimed_state(const std::string& path, const StageKey& key,
                                   const std::optional<OutputEntry>& known);
  bool is_outdated(const std::string& path, const StageKey& key) const;
  /// Of what is changed under the lock. change: nothing if it changed nothing after all.
  bool update(const Manifest::Change& change);
  /// give_name: false if it could not, and nothing is entered; that is returned.
  bool insert(const std::string& path, const OutputEntry& entry, const std::function<bool()>& give_name);

  std::string folder_, shot_name_;
  std::set<std::string> protected_;  ///< whole paths without links to folders
  const Log& log_;
  mutable std::recursive_mutex mutex_;  ///< of what follows; recursive: a change asks for what is there
  Manifest manifest_;
  SettingsSnapshot settings_;
  std::string settings_id_;
};

}  // namespace softreel
