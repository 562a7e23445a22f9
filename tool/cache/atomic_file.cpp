#include "tool/cache/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <regex>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tool/cache/file_lock.h"

namespace softreel {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kTemporaryEnding = ".part";

std::string advice(int code) {
  if (code == ENOSPC || code == EDQUOT)
    return "Free some space, or choose another folder with --output (--cache, if it is the cache).";
  if (code == EACCES || code == EROFS || code == EPERM)
    return "Accepted: a folder that can be written. Choose one with --output DIR (--cache DIR, if it is the cache).";
  return "Check the path, or choose another folder with --output (--cache, if it is the cache).";
}

/// A name in the same folder that nobody else uses and that no pattern of the outputs matches.
std::string temporary_name(const std::string& path) {
  static std::atomic<int> counter{0};
  const fs::path p(path);
  const std::string name =
      fmt::format(".{}.{}.{}.{}{}", p.filename().string(), host_name(), ::getpid(), ++counter, kTemporaryEnding);
  return (p.parent_path() / name).string();
}

fs::path folder_of(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

/// With what the system said last.
[[noreturn]] void fail_at(const std::string& path, const char* what) {
  const int code = errno;
  throw work_error(
      fmt::format("{}: {}: {}.\n  {} Finished files are intact.", path, what, std::strerror(code), advice(code)));
}

void write_all(int descriptor, std::span<const std::uint8_t> bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) fail_at(path, "cannot be written");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// An open file that is closed whatever happens.
struct OpenFile {
  explicit OpenFile(int opened) : descriptor(opened) {}
  ~OpenFile() {
    if (descriptor >= 0) ::close(descriptor);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int descriptor;
};

}  // namespace

bool is_temporary_name(const std::string& name) {
  static const std::regex form(R"(\..+\.[^/]+\.[0-9]+\.[0-9]+\.part)");
  return std::regex_match(name, form);
}

AtomicFile::AtomicFile(std::string path, Writer writer) : path_(std::move(path)) {
  const std::string folder = folder_of(path_).string();
  make_folder(folder);
  if (writer == Writer::Ours) descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor_ >= 0) {
    ::flock(descriptor_, LOCK_EX | LOCK_NB);  // tells sweep_temporaries that somebody is at work
    return;
  }
  do {  // until no sweep came between making and locking it
    if (descriptor_ >= 0) ::close(descriptor_);
    temporary_ = temporary_name(path_);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail("cannot be created");
    // A sweep that holds it is about to remove it. Where there are no locks (another errno) nothing is swept either.
  } while ((::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) ||
           ::access(temporary_.c_str(), F_OK) != 0);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  ::close(descriptor_);
}

void AtomicFile::fail(const char* what) const {
  fail_at(path_, what);
}

void AtomicFile::write(std::span<const std::uint8_t> bytes) {
  write_all(descriptor_, bytes, path_);
}

void AtomicFile::give_name() {
  if (temporary_.empty()) {
    const std::string unnamed = fmt::format("/proc/self/fd/{}", descriptor_);
    if (::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, path_.c_str(), AT_SYMLINK_FOLLOW) == 0) return;
    if (errno != EEXIST) fail("cannot be written");
    const std::string name = temporary_name(path_);
    if (::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) fail("cannot be written");
    temporary_ = name;
  }
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot be written");
  temporary_.clear();
}

void AtomicFile::flush() {
  if (::fsync(descriptor_) != 0) fail("cannot be written");
}

void AtomicFile::commit(Flush when) {
  if (when == Flush::ToDisk) flush();
  give_name();
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) fail("cannot be written");  // network file systems report a full disk here
}

void write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void write_file(const std::string& path, const std::string& text) {
  write_file(path, bytes_of(text));
}

std::size_t append_to_file(const std::string& path, std::size_t size, const std::string& text) {
  const int how = O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | (size == 0 ? O_TRUNC : 0);
  OpenFile file(::open(path.c_str(), how, 0666));
  struct stat found {};
  if (file.descriptor < 0 || ::fstat(file.descriptor, &found) != 0) fail_at(path, "cannot be opened");
  const auto there = static_cast<std::size_t>(found.st_size);
  const std::string added = (there == size ? "" : "~\n") + text;
  write_all(file.descriptor, bytes_of(added), path);
  if (::fdatasync(file.descriptor) != 0) fail_at(path, "cannot be written");
  const int descriptor = std::exchange(file.descriptor, -1);
  if (::close(descriptor) != 0) fail_at(path, "cannot be written");  // network file systems report a full disk here
  return there + added.size();
}

bool link_file(const std::string& from, const std::string& to) {
  make_folder(folder_of(to).string());
  if (::link(from.c_str(), to.c_str()) == 0) return true;
  if (errno != EEXIST) return false;
  const std::string name = temporary_name(to);
  if (::link(from.c_str(), name.c_str()) != 0) return false;
  // rename() does nothing, and leaves both names, where they are links to one file already.
  const bool renamed = ::rename(name.c_str(), to.c_str()) == 0;
  ::unlink(name.c_str());
  return renamed;
}

std::vector<std::uint8_t> read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
  if (size < 0 || fs::is_directory(path))
    throw input_error(fmt::format("{}: cannot be read: {}.\n  Accepted: a readable file. Check the path.", path,
                                  fs::is_directory(path) ? "it is a folder" : std::strerror(errno)));
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), size);
  if (!in && size > 0) throw input_error(fmt::format("{}: cannot be read to its end.", path));
  return bytes;
}

void make_folder(const std::string& path) {
  std::error_code code;
  fs::create_directories(path, code);
  if (!code && fs::is_directory(path)) return;
  const std::string reason = code ? code.message() : "something that is no folder has this name";
  throw work_error(fmt::format("{}: cannot be made a folder: {}.\n  {}", path, reason, advice(code.value())));
}

void require_writable(const std::string& folder) {
  make_folder(folder);
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor >= 0) {
    ::close(descriptor);
  } else {
    const AtomicFile probe((fs::path(folder) / "writable").string());
  }
}

Swept sweep_temporaries(const std::string& folder, bool dry_run) {
  Swept swept;
  std::error_code problem;
  for (fs::directory_iterator entry(folder, problem), end; !problem && entry != end; entry.increment(problem)) {
    const std::string name = entry->path().filename().string();
    if (!is_temporary_name(name)) continue;
    const int descriptor = ::open(entry->path().c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0) continue;
    const bool nobody_writes = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;  // false too where there are no locks
    std::error_code none;
    const auto size = entry->file_size(none);
    if (nobody_writes && (dry_run || ::unlink(entry->path().c_str()) == 0)) {
      ++swept.files;
      swept.bytes += none ? 0.0 : static_cast<double>(size);
    }
    ::close(descriptor);
  }
  return swept;
}

}  // namespace softreel
