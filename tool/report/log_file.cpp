#include "tool/report/log_file.h"

#include <cerrno>
#include <cstring>
#include <ctime>

#include <fmt/format.h>
#include <unistd.h>

#include "core/base/error.h"

namespace softreel {
namespace {

LogLevel& shown_level() {
  static LogLevel level = LogLevel::Info;
  return level;
}

std::string local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  char text[32];
  return std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts) > 0 ? text : "no time";
}

}  // namespace

LogFile::~LogFile() {
  if (file_ != nullptr) std::fclose(file_);
}

void LogFile::open(const std::string& path) {
  const std::lock_guard lock(mutex_);
  file_ = std::fopen(path.c_str(), "ae");
  if (file_ == nullptr)
    throw work_error(
        fmt::format("--log-file {}: cannot be opened: {}.\n  Accepted: a file in a folder that is there and "
                    "may be written. Correct the path.",
                    path, std::strerror(errno)));
  path_ = path;
  std::setvbuf(file_, nullptr, _IOLBF, 1 << 16);
}

void LogFile::add(LogLevel level, const std::string& line) {
  const std::lock_guard lock(mutex_);
  if (file_ == nullptr) return;
  std::fputs(fmt::format("{} {} {}: {}\n", local_time(), getpid(), level_name(level), line).c_str(), file_);
}

LogFile& log_file() {
  static LogFile file;
  return file;
}

const char* level_name(LogLevel level) {
  static constexpr const char* kNames[] = {"error", "warning", "info", "debug"};
  return kNames[static_cast<int>(level)];
}

std::optional<LogLevel> level_named(const std::string& name) {
  for (const LogLevel level : {LogLevel::Error, LogLevel::Warning, LogLevel::Info, LogLevel::Debug})
    if (name == level_name(level)) return level;
  return std::nullopt;
}

void set_log_output(const LogOutput& output) {
  shown_level() = output.level;
  if (!output.file.empty()) log_file().open(output.file);
}

bool shows(LogLevel level) {
  return level <= shown_level();
}

void say_error(const std::string& message) {
  log_file().add(LogLevel::Error, message);
  std::fprintf(stderr, "\nsoftreel: %s\n", message.c_str());
}

}  // namespace softreel
