/// Streams that write under a root become streams of ours: those of glibc write behind the back of any other library.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include "tests/support/abuse/abuse.h"

namespace {

struct Streams {
  std::mutex mutex;
  std::map<FILE*, int> fds;
};

Streams& streams() {
  static auto* instance = new Streams;  // outlives the streams that are closed at the end of the process
  return *instance;
}

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

int fd_of(void* cookie) {
  return static_cast<int>(reinterpret_cast<std::intptr_t>(cookie));
}

/// 0 stands for an error here.
ssize_t write_cookie(void* cookie, const char* data, size_t size) {
  size_t done = 0;
  while (done < size) {
    const ssize_t written = ::write(fd_of(cookie), data + done, size - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return 0;
    done += static_cast<size_t>(written);
  }
  return static_cast<ssize_t>(done);
}

ssize_t read_cookie(void* cookie, char* data, size_t size) {
  return ::read(fd_of(cookie), data, size);
}

int seek_cookie(void* cookie, off64_t* offset, int origin) {
  *offset = ::lseek64(fd_of(cookie), *offset, origin);
  return *offset < 0 ? -1 : 0;
}

int close_cookie(void* cookie) {
  return ::close(fd_of(cookie));
}

int flags_of(const char* mode) {
  const int access = std::strchr(mode, '+') != nullptr ? O_RDWR : O_WRONLY;
  if (mode[0] == 'w') return access | O_CREAT | O_TRUNC;
  if (mode[0] == 'a') return access | O_CREAT | O_APPEND;
  return access;
}

FILE* watched_stream(int fd, const char* mode) {
  FILE* stream = ::fopencookie(reinterpret_cast<void*>(static_cast<std::intptr_t>(fd)), mode,
                               {read_cookie, write_cookie, seek_cookie, close_cookie});
  if (stream == nullptr) return nullptr;
  const std::lock_guard lock(streams().mutex);
  streams().fds[stream] = fd;
  return stream;
}

bool only_reads(const char* mode) {
  return mode[0] == 'r' && std::strchr(mode, '+') == nullptr;
}

FILE* open_stream(const char* path, const char* mode, const char* name) {
  if (only_reads(mode) || !abuse::is_watched(abuse::path_of(AT_FDCWD, path)))
    return next<FILE*(const char*, const char*)>(name)(path, mode);
  const int fd = ::open(path, flags_of(mode), 0666);
  return fd < 0 ? nullptr : watched_stream(fd, mode);
}

}  // namespace

ABUSE_CALL FILE* fopen(const char* path, const char* mode) {
  return open_stream(path, mode, "fopen");
}

ABUSE_CALL FILE* fopen64(const char* path, const char* mode) {
  return open_stream(path, mode, "fopen64");
}

ABUSE_CALL FILE* fdopen(int fd, const char* mode) noexcept {
  if (only_reads(mode) || !abuse::is_watched(abuse::path_of(fd)))
    return next<FILE*(int, const char*)>("fdopen")(fd, mode);
  return watched_stream(fd, mode);
}

ABUSE_CALL int fileno(FILE* stream) noexcept {
  {
    const std::lock_guard lock(streams().mutex);
    const auto found = streams().fds.find(stream);
    if (found != streams().fds.end()) return found->second;
  }
  return next<int(FILE*)>("fileno")(stream);
}

ABUSE_CALL int fclose(FILE* stream) {
  {
    const std::lock_guard lock(streams().mutex);
    streams().fds.erase(stream);
  }
  return next<int(FILE*)>("fclose")(stream);
}
