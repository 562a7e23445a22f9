/// What a person sees while a command runs: messages and progress, on standard error.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "core/base/log.h"

namespace softreel {

enum class Verbosity {
  Quiet,  ///< warnings and errors only
  Normal
};

/// Progress is a bar with the time left on a terminal, and a plain line now and then elsewhere. Thread-safe.
class Console {
 public:
  Console(Verbosity verbosity, bool is_terminal);

  void info(const std::string& line);
  void warn(const std::string& line);
  Log log();

  /// Starts counting towards `total` steps of what `label` names.
  void begin(const std::string& label, int total);
  /// `done` steps are finished; `note` says what the last one was.
  void advance(int done, const std::string& note);
  /// Clears the bar.
  void end();

 private:
  void print(const std::string& line);
  void clear_bar();
  std::string time_left(int done) const;

  std::mutex mutex_;
  Verbosity verbosity_;
  bool is_terminal_, bar_shown_ = false;
  std::string label_;
  int total_ = 0;
  std::chrono::steady_clock::time_point start_, last_line_;
};

/// "3 s", "2 min 05 s", "1 h 10 min".
std::string format_duration(double seconds);

/// "812 B", "3.4 MB".
std::string format_bytes(double bytes);

}  // namespace softreel
