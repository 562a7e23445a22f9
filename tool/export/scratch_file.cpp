#include "tool/export/scratch_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "core/base/error.h"

namespace softreel {
namespace {

constexpr std::uint64_t kPart = 1 << 20;

}  // namespace

ScratchFile::ScratchFile(const std::string& folder) : folder_(folder.empty() ? "." : folder) {
  descriptor_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor_ >= 0) return;
  // Where the file system has no files without a name, one that loses it at once.
  std::string name = (std::filesystem::path(folder_) / ".scratch.XXXXXX").string();
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) fail("cannot be created");
  ::unlink(name.c_str());
}

ScratchFile::~ScratchFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void ScratchFile::fail(const char* what) const {
  throw work_error(
      fmt::format("{}: a scratch file {}: {}.\n  Accepted: a folder that can be written, with room for the export "
                  "twice. Free some space, or choose another folder with --output. Finished files are intact.",
                  folder_, what, std::strerror(errno)));
}

void ScratchFile::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) fail("cannot be written");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    size_ += static_cast<std::uint64_t>(written);
  }
}

void ScratchFile::write(const std::string& text) {
  write(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

/// A part that starts at `at`; valid until the next call.
std::span<const std::uint8_t> ScratchFile::read(std::uint64_t at) const {
  buffer_.resize(static_cast<std::size_t>(std::min(kPart, size_ - at)));
  ssize_t got = 0;
  do got = ::pread(descriptor_, buffer_.data(), buffer_.size(), static_cast<off_t>(at));
  while (got < 0 && errno == EINTR);
  if (got == 0) errno = EIO;
  if (got <= 0) fail("cannot be read");
  return {reinterpret_cast<const std::uint8_t*>(buffer_.data()), static_cast<std::size_t>(got)};
}

}  // namespace softreel
