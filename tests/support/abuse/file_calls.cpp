/// Calls that create, sync, rename, link and remove.
#include <cstdarg>
#include <cstdio>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "tests/support/abuse/abuse.h"

using abuse::may_change;
using abuse::path_of;

namespace {

/// An open that only reads is let through without a look: it comes from everywhere, also before main.
int open_at(int folder, const char* path, int flags, mode_t mode) {
  const bool changes = (flags & O_ACCMODE) != O_RDONLY || (flags & (O_CREAT | O_TRUNC)) != 0;
  const bool only_opens =
      (flags & O_ACCMODE) == O_RDONLY && (flags & O_TRUNC) == 0 && ::syscall(SYS_faccessat, folder, path, F_OK) == 0;
  if (changes && !only_opens && !may_change(path_of(folder, path))) return -1;
  const auto opened = static_cast<int>(::syscall(SYS_openat, folder, path, flags, mode));
  if (changes && !only_opens) {
    const int code = errno;
    abuse::pause_beside(path_of(folder, path));
    errno = code;
  }
  return opened;
}

mode_t mode_argument(int flags, va_list arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

int rename_at(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  if (!may_change(path_of(to_folder, to))) return -1;
  return static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

int unlink_at(int folder, const char* path, int flags) {
  if (!may_change(path_of(folder, path))) return -1;
  return static_cast<int>(::syscall(SYS_unlinkat, folder, path, flags));
}

int sync_fd(long call, int fd) {
  if (!may_change(path_of(fd))) return -1;
  return static_cast<int>(::syscall(call, fd));
}

}  // namespace

#define ABUSE_OPEN(name)                                  \
  ABUSE_CALL int name(const char* path, int flags, ...) { \
    va_list arguments;                                    \
    va_start(arguments, flags);                           \
    const mode_t mode = mode_argument(flags, arguments);  \
    va_end(arguments);                                    \
    return open_at(AT_FDCWD, path, flags, mode);          \
  }
#define ABUSE_OPENAT(name)                                            \
  ABUSE_CALL int name(int folder, const char* path, int flags, ...) { \
    va_list arguments;                                                \
    va_start(arguments, flags);                                       \
    const mode_t mode = mode_argument(flags, arguments);              \
    va_end(arguments);                                                \
    return open_at(folder, path, flags, mode);                        \
  }
ABUSE_OPEN(open)
ABUSE_OPEN(open64)
ABUSE_OPENAT(openat)
ABUSE_OPENAT(openat64)

ABUSE_CALL int creat(const char* path, mode_t mode) {
  return open_at(AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, mode);
}

ABUSE_CALL int mkdirat(int folder, const char* path, mode_t mode) noexcept {
  // An existing folder is said before a read-only disk, as the kernel does.
  const bool exists = ::syscall(SYS_faccessat, folder, path, F_OK) == 0;
  if (!exists && !may_change(path_of(folder, path))) return -1;
  return static_cast<int>(::syscall(SYS_mkdirat, folder, path, mode));
}

ABUSE_CALL int mkdir(const char* path, mode_t mode) noexcept {
  return mkdirat(AT_FDCWD, path, mode);
}

ABUSE_CALL int access(const char* path, int mode) noexcept {
  if ((mode & W_OK) != 0 && abuse::is_read_only(path_of(AT_FDCWD, path))) return -1;
  return static_cast<int>(::syscall(SYS_faccessat, AT_FDCWD, path, mode));
}

ABUSE_CALL int faccessat(int folder, const char* path, int mode, int flags) noexcept {
  if ((mode & W_OK) != 0 && abuse::is_read_only(path_of(folder, path))) return -1;
  return static_cast<int>(::syscall(SYS_faccessat2, folder, path, mode, flags));
}

ABUSE_CALL int fsync(int fd) {
  return sync_fd(SYS_fsync, fd);
}

ABUSE_CALL int fdatasync(int fd) {
  return sync_fd(SYS_fdatasync, fd);
}

ABUSE_CALL int ftruncate64(int fd, off64_t size) noexcept {
  if (!may_change(path_of(fd))) return -1;
  return static_cast<int>(::syscall(SYS_ftruncate, fd, size));
}

ABUSE_CALL int ftruncate(int fd, off_t size) noexcept {
  return ftruncate64(fd, size);
}

ABUSE_CALL int rename(const char* from, const char* to) noexcept {
  return rename_at(AT_FDCWD, from, AT_FDCWD, to, 0);
}

ABUSE_CALL int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  return rename_at(from_folder, from, to_folder, to, 0);
}

ABUSE_CALL int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  return rename_at(from_folder, from, to_folder, to, flags);
}

ABUSE_CALL int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  if (!may_change(path_of(to_folder, to))) return -1;
  return static_cast<int>(::syscall(SYS_linkat, from_folder, from, to_folder, to, flags));
}

ABUSE_CALL int link(const char* from, const char* to) noexcept {
  return linkat(AT_FDCWD, from, AT_FDCWD, to, 0);
}

ABUSE_CALL int symlinkat(const char* target, int folder, const char* path) noexcept {
  if (!may_change(path_of(folder, path))) return -1;
  return static_cast<int>(::syscall(SYS_symlinkat, target, folder, path));
}

ABUSE_CALL int symlink(const char* target, const char* path) noexcept {
  return symlinkat(target, AT_FDCWD, path);
}

ABUSE_CALL int unlinkat(int folder, const char* path, int flags) noexcept {
  return unlink_at(folder, path, flags);
}

ABUSE_CALL int unlink(const char* path) noexcept {
  return unlink_at(AT_FDCWD, path, 0);
}

ABUSE_CALL int rmdir(const char* path) noexcept {
  return unlink_at(AT_FDCWD, path, AT_REMOVEDIR);
}

ABUSE_CALL int remove(const char* path) noexcept {
  struct stat facts {};
  const bool is_folder = ::lstat(path, &facts) == 0 && S_ISDIR(facts.st_mode);
  return unlink_at(AT_FDCWD, path, is_folder ? AT_REMOVEDIR : 0);
}

ABUSE_CALL int utimensat(int folder, const char* path, const timespec times[2], int flags) noexcept {
  if (!may_change(path_of(folder, path))) return -1;
  return static_cast<int>(::syscall(SYS_utimensat, folder, path, times, flags));
}
