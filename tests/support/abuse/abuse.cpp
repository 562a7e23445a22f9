#include "tests/support/abuse/abuse.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <optional>
#include <sstream>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace abuse {
namespace {

/// The contents of ABUSE_COUNT_FILE.
struct Counters {
  std::atomic<std::uint64_t> calls, bytes;
};

struct Settings {
  std::vector<std::string> roots, read_only;
  std::optional<std::uint64_t> kill_at, disk_bytes, short_seed, pause_seed, clock_seed;
  Counters own{};
  Counters* counters = &own;
};

std::vector<std::string> folders_of(const char* name) {
  const char* value = std::getenv(name);
  std::vector<std::string> folders;
  std::stringstream text(value == nullptr ? "" : value);
  for (std::string folder; std::getline(text, folder, ':');)
    if (!folder.empty()) folders.push_back(folder);
  return folders;
}

std::optional<std::uint64_t> number_of(const char* name) {
  const char* value = std::getenv(name);
  if (value == nullptr || *value == 0) return std::nullopt;
  return std::strtoull(value, nullptr, 10);
}

/// Counters in a file are shared by all processes that name it, and stay when a process is killed.
Counters* shared_counters(const char* path) {
  const long fd = ::syscall(SYS_openat, AT_FDCWD, path, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0 || ::syscall(SYS_ftruncate, fd, sizeof(Counters)) != 0) std::abort();
  void* memory =
      ::mmap(nullptr, sizeof(Counters), PROT_READ | PROT_WRITE, MAP_SHARED, static_cast<int>(fd), 0);  // kept open
  if (memory == MAP_FAILED) std::abort();
  return static_cast<Counters*>(memory);
}

Settings* read_settings() {
  auto* settings = new Settings;  // outlives every caller, also those of destructors at the end of the process
  settings->roots = folders_of("ABUSE_ROOT");
  settings->read_only = folders_of("ABUSE_READ_ONLY");
  settings->kill_at = number_of("ABUSE_KILL_AT");
  settings->disk_bytes = number_of("ABUSE_DISK_BYTES");
  settings->short_seed = number_of("ABUSE_SHORT");
  settings->pause_seed = number_of("ABUSE_PAUSE");
  settings->clock_seed = number_of("ABUSE_CLOCK");
  if (const char* file = std::getenv("ABUSE_COUNT_FILE")) settings->counters = shared_counters(file);
  return settings;
}

Settings& settings() {
  static Settings* instance = read_settings();
  return *instance;
}

/// Children take the environment as it is later, so what is not for them goes when the library has been loaded.
__attribute__((constructor)) void leave_children_alone() {
  settings();
  if (std::getenv("ABUSE_CHILDREN") == nullptr) ::unsetenv("LD_PRELOAD");
}

bool is_under(const std::string& path, const std::vector<std::string>& folders) {
  for (const std::string& folder : folders)
    if (path.starts_with(folder) && (path.size() == folder.size() || path[folder.size()] == '/')) return true;
  return false;
}

/// A well mixed number for the n-th draw of a seed (the finaliser of splitmix64).
std::uint64_t draw(std::uint64_t seed) {
  static std::atomic<std::uint64_t> count{0};
  std::uint64_t z = seed * 0x2545f4914f6cdd1dU + (count.fetch_add(1) + 1) * 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

/// Counts a call; true if the process is to end here.
bool is_last_call() {
  const std::uint64_t number = settings().counters->calls.fetch_add(1) + 1;
  return settings().kill_at && number == *settings().kill_at;
}

[[noreturn]] void end_process() {
  ::syscall(SYS_kill, ::getpid(), SIGKILL);
  for (;;) ::pause();
}

/// Takes up to `size` bytes of the disk; 0 if it is full.
std::size_t take_space(std::size_t size) {
  std::atomic<std::uint64_t>& used = settings().counters->bytes;
  if (!settings().disk_bytes) {
    used.fetch_add(size);
    return size;
  }
  std::uint64_t before = used.load();
  for (;;) {
    const std::uint64_t left = *settings().disk_bytes > before ? *settings().disk_bytes - before : 0;
    const std::size_t taken = left < size ? static_cast<std::size_t>(left) : size;
    if (used.compare_exchange_weak(before, before + taken)) return taken;
  }
}

/// A random part of `size`, at least 1; 0 with EINTR in 1 of 8 cases.
std::size_t short_size(std::size_t size) {
  if (!settings().short_seed || size == 0) return size;
  const std::uint64_t number = draw(*settings().short_seed);
  if (number % 8 == 0) {
    errno = EINTR;
    return 0;
  }
  return 1 + static_cast<std::size_t>(number / 8 % size);
}

}  // namespace

std::string path_of(int fd) {
  const std::string link = "/proc/self/fd/" + std::to_string(fd);
  char target[4096];
  const ssize_t size = ::readlink(link.c_str(), target, sizeof(target));
  return size < 0 ? std::string() : std::string(target, static_cast<std::size_t>(size));
}

std::string path_of(int folder_fd, const char* path) {
  if (path == nullptr || *path == 0) return path_of(folder_fd);
  std::filesystem::path full = path;
  if (full.is_relative()) {
    char folder[4096];
    full = (folder_fd == AT_FDCWD ? std::string(::getcwd(folder, sizeof(folder))) : path_of(folder_fd)) / full;
  }
  std::string normal = full.lexically_normal().string();
  if (normal.size() > 1 && normal.back() == '/') normal.pop_back();
  return normal;
}

bool is_watched(const std::string& path) {
  return is_under(path, settings().roots) || is_under(path, settings().read_only);
}

void pause_beside(const std::string& path) {
  if (!settings().pause_seed || !is_under(path, settings().roots)) return;
  const std::uint64_t number = draw(*settings().pause_seed);
  const timespec time{0, static_cast<long>(number / 2 % 3'000'000)};
  if (number % 2 == 0) ::syscall(SYS_nanosleep, &time, nullptr);
}

bool may_change(const std::string& path) {
  pause_beside(path);
  if (is_under(path, settings().roots) && is_last_call()) end_process();
  return !is_read_only(path);
}

bool is_read_only(const std::string& path) {
  if (!is_under(path, settings().read_only)) return false;
  errno = EROFS;
  return true;
}

std::size_t writable(int fd, std::size_t size, void (*write_half)(void*), void* context) {
  if (!is_under(path_of(fd), settings().roots)) return size;
  if (is_last_call()) {
    write_half(context);
    end_process();
  }
  const std::size_t tried = short_size(size);
  if (tried == 0) return 0;
  const std::size_t taken = take_space(tried);
  if (taken == 0) errno = ENOSPC;
  return taken;
}

std::size_t readable(int fd, std::size_t size) {
  if (!settings().short_seed || !is_under(path_of(fd), settings().roots)) return size;
  return short_size(size);
}

bool has_hostile_clock() {
  return settings().clock_seed.has_value();
}

std::int64_t clock_jump() {
  constexpr std::int64_t kTenYears = 10LL * 365 * 24 * 3600;
  return static_cast<std::int64_t>(draw(*settings().clock_seed) % (2 * kTenYears)) - kTenYears;
}

}  // namespace abuse
