#include "tool/batch/batch_display.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "core/base/timer.h"
#include "tool/report/log_file.h"

namespace softreel {
namespace {

constexpr std::chrono::milliseconds kBetweenDrawings{100};
constexpr std::chrono::seconds kBetweenLines{15};
constexpr double kShortestJob = 0.5;  ///< s: what starting and ending take counts for the smallest too

/// At most `width` bytes of the text, cut between characters.
std::string cut(const std::string& text, std::size_t width) {
  if (text.size() <= width) return text;
  std::size_t end = width;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end);
}

std::string bar(double share, int width) {
  const int filled = std::clamp(static_cast<int>(share * width), 0, width);
  return "[" + std::string(static_cast<std::size_t>(filled), '=') +
         std::string(static_cast<std::size_t>(width - filled), ' ') + "]";
}

}  // namespace

TerminalSize terminal_size() {
  if (::isatty(STDERR_FILENO) == 0) return {};
  winsize size{};
  const bool is_said = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0;
  return is_said ? TerminalSize{size.ws_col, size.ws_row} : TerminalSize{80, 24};
}

BatchDisplay::BatchDisplay(Verbosity verbosity, const TerminalSize& terminal)
    : verbosity_(verbosity),
      is_terminal_(terminal.columns > 0),
      columns_(static_cast<std::size_t>(std::max(20, terminal.columns))),
      rows_(static_cast<std::size_t>(std::max(3, terminal.rows))) {}

void BatchDisplay::print(const std::string& line) {
  clear();
  std::fprintf(stderr, "%s\n", line.c_str());
  std::fflush(stderr);
}

void BatchDisplay::info(const std::string& line) {
  log_file().add(LogLevel::Info, line);
  if (verbosity_ == Verbosity::Normal) print(line);
}

void BatchDisplay::warn(const std::string& line) {
  log_file().add(LogLevel::Warning, line);
  print(line);
}

void BatchDisplay::begin(std::size_t jobs, double expected_seconds) {
  jobs_ = jobs;
  expected_seconds_ = std::max(expected_seconds, kShortestJob * static_cast<double>(jobs));
  start_ = last_tick_ = Clock::now();
}

void BatchDisplay::start(std::size_t job, const std::string& label, const std::string& how, double expected_seconds) {
  running_.push_back({job, label, "starting", 0, 0, std::max(kShortestJob, expected_seconds), Clock::now()});
  const std::string line = fmt::format("start   {} ({})", label, how);
  if (is_terminal_)
    log_file().add(LogLevel::Info, line);  // it has a line of its own there
  else
    info(line);
}

void BatchDisplay::progress(std::size_t job, int done, int total, const std::string& note) {
  for (Running& one : running_) {
    if (one.job != job) continue;
    one.done = done;
    one.total = total;
    if (!note.empty()) one.note = note;
  }
}

void BatchDisplay::end(std::size_t job, bool for_good, bool failed, const std::string& line) {
  const auto one = std::find_if(running_.begin(), running_.end(), [&](const Running& r) { return r.job == job; });
  if (one == running_.end()) return;
  if (for_good) {
    ended_ += 1;
    failed_ += failed ? 1 : 0;
    ended_seconds_ += one->expected_seconds;
  }
  running_.erase(one);
  log_file().add(failed ? LogLevel::Warning : LogLevel::Info, line);
  if (failed || verbosity_ == Verbosity::Normal) print(line);
}

double BatchDisplay::share_done() const {
  double done = ended_seconds_;
  for (const Running& one : running_)
    if (one.total > 0) done += one.expected_seconds * one.done / one.total;
  return std::min(1.0, done / expected_seconds_);
}

std::string BatchDisplay::whole_line() const {
  const double share = share_done(), elapsed = seconds_since(start_);
  std::string line = fmt::format("batch   {} {} of {} done", is_terminal_ ? bar(share, 24) : "", ended_, jobs_);
  if (failed_ > 0) line += fmt::format(", {} failed", failed_);
  line += fmt::format(", {} running, {} waiting", running_.size(), jobs_ - std::min(jobs_, ended_ + running_.size()));
  constexpr double kTooEarly = 0.02;  // to tell anything from
  if (share > kTooEarly && share < 1)
    line += fmt::format("; about {} left", format_duration(elapsed / share * (1 - share)));
  return line;
}

std::string BatchDisplay::line_of(const Running& one, std::size_t width) const {
  const std::string frames = one.total > 0 ? fmt::format("frame {:>4}/{}", one.done, one.total) : one.note;
  return fmt::format("  {:<{}}  {}  {}  {}", cut(one.label, width), width,
                     bar(one.total > 0 ? static_cast<double>(one.done) / one.total : 0, 16),
                     format_duration(seconds_since(one.start)), frames);
}

void BatchDisplay::clear() {
  if (drawn_ == 0) return;
  std::fprintf(stderr, "\033[%dA\r\033[J", drawn_);
  drawn_ = 0;
}

void BatchDisplay::draw() {
  clear();
  std::size_t width = 8;
  for (const Running& one : running_) width = std::max(width, one.label.size());
  width = std::min(width, columns_ / 2);
  const std::size_t shown = std::min(running_.size(), rows_ - 2);  // what scrolls away cannot be drawn over
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) text += cut(line_of(running_[i], width), columns_ - 1) + "\n";
  text += cut(whole_line(), columns_ - 1) + "\n";
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
  drawn_ = static_cast<int>(shown) + 1;
}

void BatchDisplay::tick() {
  if (verbosity_ == Verbosity::Quiet) return;
  const auto now = Clock::now();
  if (is_terminal_) {
    if (now - last_tick_ < kBetweenDrawings && drawn_ > 0) return;
    last_tick_ = now;
    draw();
    return;
  }
  if (now - last_tick_ < kBetweenLines) return;
  last_tick_ = now;
  std::string line = whole_line();
  for (const Running& one : running_)
    if (one.total > 0) line += fmt::format("; {} {}/{}", one.label, one.done, one.total);
  print(line);
}

void BatchDisplay::finish() {
  clear();
  std::fflush(stderr);
}

}  // namespace softreel
