#include "tool/batch/machine.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <thread>

#include <sched.h>

namespace softreel {
namespace {

namespace fs = std::filesystem;

std::optional<double> number_in(const fs::path& path) {
  std::ifstream in(path);
  double value = 0;
  if (!(in >> value)) return std::nullopt;  // "max" too: no limit
  return value;
}

/// Of a group's memory, what its files take: it goes as soon as something else needs it.
double file_cache_of(const fs::path& group) {
  std::ifstream in(group / "memory.stat");
  std::string word;
  double bytes = 0, value = 0;
  while (in >> word >> value)
    if (word == "inactive_file" || word == "active_file") bytes += value;
  return bytes;
}

}  // namespace

double left_by_control_groups(const std::string& membership, const std::string& root) {
  double left = std::numeric_limits<double>::infinity();
  std::ifstream in(membership);
  std::string line;
  while (std::getline(in, line)) {
    if (!line.starts_with("0::")) continue;
    fs::path group = fs::path(root) / fs::path(line.substr(3)).relative_path();
    while (true) {
      const auto limit = number_in(group / "memory.max"), used = number_in(group / "memory.current");
      if (limit && used) left = std::min(left, std::max(0.0, *limit - std::max(0.0, *used - file_cache_of(group))));
      if (group == root || !group.has_relative_path()) break;
      group = group.parent_path();
    }
  }
  return left;
}

int usable_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

double available_memory() {
  std::ifstream in("/proc/meminfo");
  std::string word;
  double kilobytes = 0, available = std::numeric_limits<double>::infinity();
  while (in >> word)
    if (word == "MemAvailable:" && in >> kilobytes) available = 1024 * kilobytes;
  return std::min(available, left_by_control_groups("/proc/self/cgroup", "/sys/fs/cgroup"));
}

std::string program_path() {
  std::error_code none;
  const fs::path path = fs::read_symlink("/proc/self/exe", none);
  return none ? "/proc/self/exe" : path.string();
}

}  // namespace softreel
