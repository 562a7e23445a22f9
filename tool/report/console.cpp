#include "tool/report/console.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "core/base/timer.h"
#include "tool/report/log_file.h"

namespace softreel {

Console::Console(Verbosity verbosity, bool is_terminal) : verbosity_(verbosity), is_terminal_(is_terminal) {}

Log Console::log() {
  return {[this](const std::string& line) { info(line); }, [this](const std::string& line) { warn(line); }};
}

void Console::clear_bar() {
  if (bar_shown_) std::fputs("\r\033[K", stderr);
  bar_shown_ = false;
}

void Console::print(const std::string& line) {
  clear_bar();
  std::fprintf(stderr, "%s\n", line.c_str());
  std::fflush(stderr);
}

bool Console::shows_info() const {
  return verbosity_ == Verbosity::Normal && shows(LogLevel::Info);
}

void Console::debug(const std::string& line) {
  const std::lock_guard lock(mutex_);
  log_file().add(LogLevel::Debug, line);
  if (shows(LogLevel::Debug)) print(line);
}

void Console::info(const std::string& line) {
  const std::lock_guard lock(mutex_);
  log_file().add(LogLevel::Info, line);
  if (shows_info()) print(line);
}

void Console::warn(const std::string& line) {
  const std::lock_guard lock(mutex_);
  log_file().add(LogLevel::Warning, line);
  if (shows(LogLevel::Warning)) print("warning: " + line);
}

void Console::begin(const std::string& label, int total) {
  const std::lock_guard lock(mutex_);
  label_ = label;
  total_ = total;
  start_ = last_line_ = std::chrono::steady_clock::now();
}

std::string Console::time_left(int done) const {
  const double elapsed = seconds_since(start_);
  if (done == 0 || done >= total_) return {};
  return format_duration(elapsed / done * (total_ - done)) + " left";
}

void Console::advance(int done, const std::string& note) {
  const std::lock_guard lock(mutex_);
  if (!shows_info()) return;
  const std::string left = time_left(done);
  if (is_terminal_) {
    constexpr int kWidth = 30;
    const int filled = total_ > 0 ? kWidth * done / total_ : kWidth;
    clear_bar();
    std::fprintf(stderr, "%s [%s%s] %d/%d  %s  %s", label_.c_str(), std::string(filled, '=').c_str(),
                 std::string(kWidth - filled, ' ').c_str(), done, total_, note.c_str(), left.c_str());
    bar_shown_ = true;
    std::fflush(stderr);
    return;
  }
  // Without a terminal: the first, the last, and at most one line every few seconds between them.
  const auto now = std::chrono::steady_clock::now();
  if (done > 1 && done < total_ && now - last_line_ < std::chrono::seconds(5)) return;
  last_line_ = now;
  print(fmt::format("{} {}/{}  {}{}{}", label_, done, total_, note, left.empty() ? "" : "  ", left));
}

void Console::end() {
  const std::lock_guard lock(mutex_);
  clear_bar();
  std::fflush(stderr);
}

std::string format_duration(double seconds) {
  if (seconds < 10) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long>(std::lround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string format_bytes(double bytes) {
  const char* units[] = {"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 1000 && unit < 4) {
    bytes /= 1000;
    ++unit;
  }
  return unit == 0 ? fmt::format("{:.0f} B", bytes) : fmt::format("{:.1f} {}", bytes, units[unit]);
}

}  // namespace softreel
