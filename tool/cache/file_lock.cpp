#include "tool/cache/file_lock.h"

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <set>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace softreel {
namespace {

/// The files that go with this process: those of the locks that it holds, and its marks.
struct FilesToRemove {
  std::timed_mutex mutex;
  std::set<std::string> paths;
};

FilesToRemove& files_to_remove() {
  static auto& files = *new FilesToRemove;  // for as long as any thread runs
  return files;
}

int open_lock_file(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor >= 0 || errno != ENOENT) return descriptor;
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  return ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
}

/// Whether the locked file is still the one that the path names: its last holder may have removed it.
bool is_current(int descriptor, const std::string& path) {
  struct stat held {
  }, named{};
  return ::fstat(descriptor, &held) == 0 && ::stat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
         held.st_dev == named.st_dev;
}

int operation(FileLock::Sharing sharing) {
  return sharing == FileLock::Sharing::Shared ? LOCK_SH : LOCK_EX;
}

int lock_patiently(int descriptor, int how) {
  int result = 0;
  do {
    result = ::flock(descriptor, how);
  } while (result != 0 && errno == EINTR);
  return result;
}

}  // namespace

std::string host_name() {
  char host[256] = "host";
  ::gethostname(host, sizeof host - 1);
  return host;
}

std::optional<FileLock> FileLock::try_adopt(int descriptor, Sharing sharing) {
  FileLock lock(descriptor);
  if (lock_patiently(descriptor, operation(sharing) | LOCK_NB) == 0 || errno != EWOULDBLOCK) return lock;
  return std::nullopt;
}

std::optional<FileLock> FileLock::try_take(const std::string& path, Sharing sharing) {
  while (true) {
    const int descriptor = open_lock_file(path);
    if (descriptor < 0) return FileLock(-1);
    std::optional<FileLock> lock = try_adopt(descriptor, sharing);
    if (!lock || is_current(descriptor, path)) return lock;
  }
}

FileLock FileLock::take(const std::string& path, Sharing sharing) {
  while (true) {
    FileLock lock(open_lock_file(path));
    if (lock.descriptor_ < 0) return lock;
    // A file system without locks (errno is not EINTR here) is treated like a read-only one.
    if (lock_patiently(lock.descriptor_, operation(sharing)) != 0 || is_current(lock.descriptor_, path)) return lock;
  }
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  if (!removed_.empty()) {
    const std::lock_guard lock(files_to_remove().mutex);
    ::unlink(removed_.c_str());
    files_to_remove().paths.erase(removed_);
  }
  ::close(descriptor_);
}

FileLock&& FileLock::remove_at_end(std::string path) && {
  if (descriptor_ < 0) return std::move(*this);
  removed_ = std::move(path);
  const std::lock_guard lock(files_to_remove().mutex);
  files_to_remove().paths.insert(removed_);
  return std::move(*this);
}

void remove_at_sudden_end(const std::string& path) {
  const std::lock_guard lock(files_to_remove().mutex);
  files_to_remove().paths.insert(path);
}

void keep_at_sudden_end(const std::string& path) {
  const std::lock_guard lock(files_to_remove().mutex);
  files_to_remove().paths.erase(path);
}

void remove_lock_files_at_once() {
  // Whoever holds the mutex removes a file; on a file system that hangs the end is not to wait for that.
  if (!files_to_remove().mutex.try_lock_for(std::chrono::milliseconds(100))) return;
  for (const std::string& path : files_to_remove().paths) ::unlink(path.c_str());
}

}  // namespace softreel
