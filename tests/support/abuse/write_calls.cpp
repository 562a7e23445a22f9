/// Calls that move bytes. They go to the kernel directly: glibc's own functions would need to be looked up.
#include <algorithm>
#include <cerrno>
#include <vector>

#include <fcntl.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include "tests/support/abuse/abuse.h"

namespace {

/// Runs `transfer(size)` with as many bytes as may be written to `fd`.
template <typename Transfer>
ssize_t write_through(int fd, std::size_t size, Transfer transfer) {
  struct Half {
    Transfer& transfer;
    std::size_t size;
  } half{transfer, size / 2};
  const auto write_half = [](void* context) {
    const Half& first = *static_cast<Half*>(context);
    (void)first.transfer(first.size);
  };
  const std::size_t taken = abuse::writable(fd, size, write_half, &half);
  return taken == 0 && size > 0 ? -1 : transfer(taken);
}

/// The first `size` bytes of a list of buffers.
std::vector<iovec> first_bytes(const iovec* buffers, int count, std::size_t size) {
  std::vector<iovec> first;
  for (int i = 0; i < count && size > 0; ++i) {
    first.push_back({buffers[i].iov_base, std::min(buffers[i].iov_len, size)});
    size -= first.back().iov_len;
  }
  return first;
}

/// How many of `size` bytes a file still has from its place, or from `*at`; only these need space where they go.
std::size_t bytes_left(int in, const off64_t* at, std::size_t size) {
  struct stat facts {};
  if (::fstat(in, &facts) != 0 || !S_ISREG(facts.st_mode)) return size;
  const off64_t place = at != nullptr ? *at : ::lseek64(in, 0, SEEK_CUR);
  return place >= facts.st_size ? 0 : std::min(size, static_cast<std::size_t>(facts.st_size - place));
}

}  // namespace

ABUSE_CALL ssize_t write(int fd, const void* data, size_t size) {
  return write_through(fd, size, [&](std::size_t n) -> ssize_t { return ::syscall(SYS_write, fd, data, n); });
}

ABUSE_CALL ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) {
  return write_through(fd, size, [&](std::size_t n) -> ssize_t { return ::syscall(SYS_pwrite64, fd, data, n, at); });
}

ABUSE_CALL ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  return pwrite64(fd, data, size, at);
}

ABUSE_CALL ssize_t writev(int fd, const iovec* buffers, int count) {
  std::size_t size = 0;
  for (int i = 0; i < count; ++i) size += buffers[i].iov_len;
  return write_through(fd, size, [&](std::size_t n) -> ssize_t {
    const std::vector<iovec> first = first_bytes(buffers, count, n);
    return ::syscall(SYS_writev, fd, first.data(), first.size());
  });
}

ABUSE_CALL ssize_t copy_file_range(int in, off64_t* in_at, int out, off64_t* out_at, size_t size, unsigned flags) {
  return write_through(out, bytes_left(in, in_at, size), [&](std::size_t n) -> ssize_t {
    return ::syscall(SYS_copy_file_range, in, in_at, out, out_at, n, flags);
  });
}

ABUSE_CALL ssize_t sendfile64(int out, int in, off64_t* at, size_t size) noexcept {
  return write_through(out, bytes_left(in, at, size),
                       [&](std::size_t n) -> ssize_t { return ::syscall(SYS_sendfile, out, in, at, n); });
}

ABUSE_CALL ssize_t sendfile(int out, int in, off_t* at, size_t size) noexcept {
  return sendfile64(out, in, at, size);
}

ABUSE_CALL ssize_t read(int fd, void* data, size_t size) {
  const std::size_t taken = abuse::readable(fd, size);
  return taken == 0 && size > 0 ? -1 : ::syscall(SYS_read, fd, data, taken);
}

ABUSE_CALL ssize_t pread64(int fd, void* data, size_t size, off64_t at) {
  const std::size_t taken = abuse::readable(fd, size);
  return taken == 0 && size > 0 ? -1 : ::syscall(SYS_pread64, fd, data, taken, at);
}

ABUSE_CALL ssize_t pread(int fd, void* data, size_t size, off_t at) {
  return pread64(fd, data, size, at);
}
