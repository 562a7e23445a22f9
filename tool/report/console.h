/// What a person sees while a command runs: messages and progress, on standard error; and the log file.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>

#include "core/base/log.h"

namespace softreel {

/// How much of a command's messages its console shows, within what the program's log level lets through.
enum class Verbosity {
  Quiet,  ///< warnings and errors only
  Normal
};

/// Each level says what those before it say, and more.
enum class LogLevel { Error, Warning, Info, Debug };

/// "error", "warning", "info", "debug".
const char* level_name(LogLevel level);
/// None for any other word.
std::optional<LogLevel> level_named(const std::string& name);

/// Where messages of the whole program go. Standard error is one for the process, and so is this.
struct LogOutput {
  LogLevel level = LogLevel::Info;  ///< on standard error
  std::string file;                 ///< all levels are added to its end, with date and time; empty: none
};

/// Said once, before the first console is made. Throws work_error if the file cannot be opened.
void set_log_output(const LogOutput& output);

/// True if this process shows messages of the level.
bool shows(LogLevel level);

/// The message that ends the program: on standard error and in the log file.
void say_error(const std::string& message);

/// Progress is a bar with the time left on a terminal, and a plain line now and then elsewhere. Thread-safe.
class Console {
 public:
  Console(Verbosity verbosity, bool is_terminal);

  void debug(const std::string& line);
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
  bool shows_info() const;
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
