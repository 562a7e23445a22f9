/// Bytes that a file wants elsewhere than they come: kept on disk, in a file without a name, until their place is
/// reached.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace softreel {

/// Grows, and is copied out. It leaves nothing behind, even if the process is killed. All members throw work_error
/// naming the folder and what the system said.
class ScratchFile {
 public:
  /// folder: where the final file will lie, as that is where there must be room.
  explicit ScratchFile(const std::string& folder);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  void write(std::span<const std::uint8_t> bytes);
  void write(const std::string& text);
  std::uint64_t size() const { return size_; }

  /// Gives all bytes to `sink`, in parts of at most 1 MiB.
  template <typename Sink>
  void copy_to(const Sink& sink) const {
    for (std::uint64_t at = 0; at < size_;) {
      const std::span<const std::uint8_t> part = read(at);
      sink(part);
      at += part.size();
    }
  }

 private:
  [[noreturn]] void fail(const char* what) const;
  std::span<const std::uint8_t> read(std::uint64_t at) const;

  std::string folder_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  mutable std::string buffer_;
};

}  // namespace softreel
