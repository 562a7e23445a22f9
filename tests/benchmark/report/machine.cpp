#include "tests/benchmark/report/machine.h"

#include <ctime>
#include <fstream>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <sys/utsname.h>

#include "tool/cache/process.h"
#include "tool/report/version.h"

namespace softreel::bench {
namespace {

/// Value of the first line of a file of /proc that starts with `name`.
std::string line_of(const char* path, const std::string& name) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(name)) continue;
    const std::size_t colon = line.find_first_of(":=");
    const std::size_t start = line.find_first_not_of(" \t\"", colon + 1);
    return start == std::string::npos ? "" : line.substr(start, line.find_last_not_of(" \t\"") + 1 - start);
  }
  return "unknown";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm calendar{};
  gmtime_r(&now, &calendar);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02} UTC", calendar.tm_year + 1900, calendar.tm_mon + 1,
                     calendar.tm_mday, calendar.tm_hour, calendar.tm_min);
}

/// Other jobs that share the machine show here.
std::string load() {
  std::ifstream file("/proc/loadavg");
  std::string one;
  return file >> one ? one : "unknown";
}

/// The first line with words that a program says of itself.
std::string first_line_of(const std::vector<std::string>& command) {
  std::string said;
  if (run_process(command, &said) < 0) return "not found";
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);)
    if (line.find_first_not_of(" \t") != std::string::npos) return line;
  return "says nothing of its version";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> describe_machine() {
  utsname system{};
  uname(&system);
  return {{"Processor", line_of("/proc/cpuinfo", "model name")},
          {"Cores", std::to_string(std::thread::hardware_concurrency())},
          {"Memory", line_of("/proc/meminfo", "MemTotal")},
          {"System", fmt::format("{}, Linux {}", line_of("/etc/os-release", "PRETTY_NAME"), system.release)},
          {"softreel", version_text()},
          {"gnuplot", first_line_of({"gnuplot", "--version"})},
          {"CalculiX", first_line_of({"ccx", "-v"})},
          {"Other jobs", fmt::format("load average {} at the end, this program included", load())},
          {"Date", today()}};
}

}  // namespace softreel::bench
