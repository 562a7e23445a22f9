/// What the preloaded library does to which call; everything is chosen by environment variables.
///
/// A call counts if it would change something (create, write, sync, rename, link, remove) under one of the roots.
///   ABUSE_ROOT=DIR[:DIR...]       the roots: absolute, without symbolic links
///   ABUSE_COUNT_FILE=FILE         two 64-bit numbers, calls and bytes written under the roots; shared by all processes
///   ABUSE_KILL_AT=N               SIGKILL instead of the N-th counted call; a write has written half by then
///   ABUSE_DISK_BYTES=N            the N-th byte written under the roots is the last; every further one gives ENOSPC
///   ABUSE_READ_ONLY=DIR[:DIR...]  every change under these gives EROFS (root may write where permissions forbid)
///   ABUSE_SHORT=SEED              reads and writes under the roots take a random part, or end with EINTR
///   ABUSE_PAUSE=SEED              up to 3 ms pass before and after every second counted call: what may meet does
///   ABUSE_CLOCK=SEED              the time of day jumps by up to 10 years from call to call
///   ABUSE_CHILDREN=1              processes that the program starts are abused too; else they are left alone
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <sys/types.h>

#define ABUSE_CALL extern "C" __attribute__((visibility("default")))

namespace abuse {

/// The file that a descriptor refers to; "(deleted)" may follow, so compare the beginning only.
std::string path_of(int fd);
/// The absolute path of an argument pair of openat and its like.
std::string path_of(int folder_fd, const char* path);

/// Counts a call that would change `path`, and is the end of the process if it is the chosen one. Returns false with
/// errno set if the call must fail.
bool may_change(const std::string& path);

/// Whether nothing may be changed at `path`; errno is set then.
bool is_read_only(const std::string& path);

/// Lets some time pass, or none, beside a call that changes `path`.
void pause_beside(const std::string& path);

/// Before a write of `size` bytes to `fd`: how many may be written, 0 with errno set if none. `write_half` is called
/// before the process is killed in the middle of this write.
std::size_t writable(int fd, std::size_t size, void (*write_half)(void*), void* context);

/// Before a read of `size` bytes from `fd`: how many to read, 0 with errno set if none.
std::size_t readable(int fd, std::size_t size);

/// Whether a stream opened for writing at `path` must be watched.
bool is_watched(const std::string& path);

bool has_hostile_clock();
/// The next jump of the clock, s.
std::int64_t clock_jump();

}  // namespace abuse
