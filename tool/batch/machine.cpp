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

/// How a version of control groups calls what it says of a group's memory.
struct GroupFiles {
  const char *limit, *used;
  const char *inactive_files, *active_files;  ///< in memory.stat
};
constexpr GroupFiles kVersion1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file",
                               "total_active_file"};
constexpr GroupFiles kVersion2{"memory.max", "memory.current", "inactive_file", "active_file"};
/// Version 1 says the largest number of its pages where there is no limit.
constexpr double kNoLimit = 4e18;

/// Of a group's memory, what its files take: it goes as soon as something else needs it.
double file_cache_of(const fs::path& group, const GroupFiles& files) {
  std::ifstream in(group / "memory.stat");
  std::string word;
  double bytes = 0, value = 0;
  while (in >> word >> value)
    if (word == files.inactive_files || word == files.active_files) bytes += value;
  return bytes;
}

/// Of the group with this path below `root`, and of those above it.
double left_by(const std::string& path, const fs::path& root, const GroupFiles& files) {
  double left = std::numeric_limits<double>::infinity();
  fs::path group = root / fs::path(path).relative_path();
  while (true) {
    const auto limit = number_in(group / files.limit), used = number_in(group / files.used);
    if (limit && used && *limit < kNoLimit)
      left = std::min(left, std::max(0.0, *limit - std::max(0.0, *used - file_cache_of(group, files))));
    if (group == root || !group.has_relative_path()) return left;
    group = group.parent_path();
  }
}

/// Whether memory is among the controllers "cpu,memory".
bool has_memory(const std::string& controllers) {
  return ("," + controllers + ",").find(",memory,") != std::string::npos;
}

}  // namespace

double left_by_control_groups(const std::string& membership, const std::string& root) {
  double left = std::numeric_limits<double>::infinity();
  std::ifstream in(membership);
  std::string line;
  while (std::getline(in, line)) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);  // NUMBER:CONTROLLERS:PATH
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), path = line.substr(second + 1);
    if (controllers.empty()) left = std::min(left, left_by(path, root, kVersion2));
    if (has_memory(controllers)) left = std::min(left, left_by(path, fs::path(root) / "memory", kVersion1));
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
