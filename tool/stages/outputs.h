/// The files a run leaves in its output folder, and manifest.json, which knows their keys and checksums.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "core/base/log.h"
#include "tool/stages/key.h"

namespace softreel {

/// One output folder of one shot. A file counts as done only if the manifest has its key and its bytes have the
/// manifest's checksum. The manifest is written after each file, so that a killed run loses at most one file.
class Outputs {
 public:
  /// Reads the manifest if there is one; a damaged one is said, and all files count as unknown.
  Outputs(std::string folder, std::string shot_name, const Log& log);

  /// "DIR/SHOT.####.EXTENSION"
  std::string frame_path(int frame, const std::string& extension) const;
  /// "DIR/SHOT.EXTENSION"
  std::string path(const std::string& extension) const;
  const std::string& folder() const { return folder_; }
  const std::string& shot_name() const { return shot_name_; }

  /// True if the file is there, whole, and made from this key.
  bool is_done(const std::string& path, const StageKey& key) const;
  /// The bytes of any whole file that was made from this key, under whatever name.
  std::optional<std::vector<std::uint8_t>> find_equal(const StageKey& key) const;
  /// Writes the file, then the manifest. Throws work_error.
  void write(const std::string& path, const StageKey& key, std::span<const std::uint8_t> bytes);
  /// Enters a file that somebody else wrote (ffmpeg).
  void enter(const std::string& path, const StageKey& key);
  /// Checksum of a file that is in the manifest.
  std::string checksum(const std::string& path) const;

 private:
  struct Entry {
    StageKey key;
    std::string checksum;
  };
  void write_manifest() const;
  std::string manifest_path() const;

  std::string folder_, shot_name_;
  const Log& log_;
  std::map<std::string, Entry> entries_;  ///< by file name
};

}  // namespace softreel
