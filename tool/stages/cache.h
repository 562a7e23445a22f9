/// Results of stages on disk, found by their keys; a damaged file is said and recomputed, never used.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/log.h"
#include "tool/stages/key.h"

namespace softreel {

/// One folder of files STAGE/KEY. Several processes may share it: files are written atomically and never changed.
class Cache {
 public:
  /// The folder is made when the first result is stored.
  Cache(std::string folder, const Log& log) : folder_(std::move(folder)), log_(log) {}

  /// The stored bytes, or nothing if there are none or they are damaged (which is said).
  std::optional<std::vector<std::uint8_t>> load(const std::string& stage, const StageKey& key) const;
  /// True if a file is there; its content is not read.
  bool has(const std::string& stage, const StageKey& key) const;
  /// Throws work_error if the file cannot be written.
  void store(const std::string& stage, const StageKey& key, const std::vector<std::uint8_t>& bytes) const;

  const std::string& folder() const { return folder_; }

 private:
  std::string path(const std::string& stage, const StageKey& key) const;

  std::string folder_;
  const Log& log_;
};

}  // namespace softreel
