/// Files that are there completely or not at all: temporary name, flush, rename.
#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace softreel {

/// A file under construction. It appears under its final name at `commit`; without one it leaves nothing behind.
/// All members throw work_error naming the file and what the system said (full disk, read-only folder, ...).
class AtomicFile {
 public:
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::uint8_t> bytes);
  /// Flushes to the disk and renames to the final path.
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;

  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
};

/// Writes a whole file atomically; folders on the way are made. Throws work_error.
void write_file(const std::string& path, std::span<const std::uint8_t> bytes);
void write_file(const std::string& path, const std::string& text);

/// All bytes of a file. Throws input_error if it cannot be read.
std::vector<std::uint8_t> read_file(const std::string& path);

/// Makes a folder and those above it. Throws work_error if that fails or something else has the name.
void make_folder(const std::string& path);

}  // namespace softreel
