/// Results of stages on disk, found by their keys; a damaged file is said and recomputed, never used.
///
/// Layout of the folder, format 2: 2/STAGE/KEY results with a header line that holds checksum and cost; 2/files/SUM
/// pictures and other finished files as they are, named by their checksum alone (a search for *.png then finds the
/// outputs and nothing else); 2/uses who needs what (cache_use.h); 2/locks results that somebody is making. Several
/// processes and machines may share it: files are written atomically and never changed, and of two that want the same
/// result one makes it.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "tool/cache/file_lock.h"
#include "tool/cache/key.h"

namespace softreel {

/// Version of layout and headers; another version has another folder, so that none is misread.
inline constexpr int kCacheFormat = 2;

using Bytes = std::vector<std::uint8_t>;

/// Files in a cache folder that softreel stored in older formats.
std::vector<std::filesystem::path> older_results(const std::string& folder);

class Cache {
 public:
  /// What happens when a result cannot be stored (full disk, read-only folder).
  enum class Storing {
    Wanted,   ///< one warning, the run goes on without
    Required  ///< work_error: the cache is what the run is for
  };

  /// The folder is made when the first result is stored. Older formats in it are said.
  Cache(std::string folder, Storing storing, const Log& log);

  struct Stored {
    Bytes bytes;
    double seconds = 0;  ///< what making it took, once
  };
  /// The stored result, or nothing if there is none or it is damaged (which is said).
  std::optional<Stored> load(const std::string& stage, const StageKey& key) const;
  /// True if a file of this name is there; its content is not read.
  bool has(const std::string& stage, const StageKey& key) const;
  /// What making the result took, without reading more than the header; nothing if it is not there.
  std::optional<double> seconds(const std::string& stage, const StageKey& key) const;
  void store(const std::string& stage, const StageKey& key, const Bytes& bytes, double seconds) const;

  /// The stored result; or that of `make`, stored. While another process makes it, this one waits for that, asking
  /// `wait` (which may throw) now and then.
  struct Produced {
    Bytes bytes;
    bool from_cache = false;
    double seconds = 0;
  };
  Produced produce(const std::string& stage, const StageKey& key, const std::function<void()>& wait,
                   const std::function<Bytes()>& make) const;
  /// The right to make a result; nothing while another process has it.
  std::optional<FileLock> try_claim(const std::string& stage, const StageKey& key) const;

  struct StoredFile {
    StageKey checksum;
    bool is_there = false;  ///< false if it could not be stored
  };
  /// Stores a finished file under its checksum; a no-op if it is there, whole.
  StoredFile store_file(const Bytes& bytes) const;
  /// The bytes of a finished file, or nothing if it is not there or damaged (which is said).
  std::optional<Bytes> load_file(const StageKey& checksum) const;
  std::string file_path(const StageKey& checksum) const;

  /// Why the result cannot be used, empty if it is sound or not there. Reads all of it.
  std::string damage(const std::string& stage, const StageKey& key) const;

  /// Bytes that this object stored so far.
  std::int64_t stored_bytes() const { return stored_bytes_; }

  const std::string& folder() const { return folder_; }
  /// FOLDER/2
  std::string format_folder() const;
  std::string path(const std::string& stage, const StageKey& key) const;

 private:
  void say_older_formats() const;
  void store_or_say(const std::function<void()>& work) const;
  void say_damage(const std::string& path, const std::string& reason) const;

  std::string folder_;
  Storing storing_;
  const Log& log_;
  mutable std::atomic<bool> unwritable_{false};
  mutable std::atomic<std::int64_t> stored_bytes_{0};
  mutable std::mutex said_mutex_;
  mutable std::set<std::string> said_;  ///< damaged files, each said once
};

}  // namespace softreel
