/// The one progress display of a batch, on standard error.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "tool/report/console.h"

namespace softreel {

/// Of the terminal on standard error; no columns if there is none.
struct TerminalSize {
  int columns = 0, rows = 0;
};
TerminalSize terminal_size();

/// On a terminal a line for each running job and one for the whole, drawn over and over, with what has ended above
/// them; elsewhere plain lines: one when a job starts, one when it ends, one for the whole now and then. Quiet: only
/// failures. What is printed for good goes to the log file, too, whatever is shown.
class BatchDisplay {
 public:
  BatchDisplay(Verbosity verbosity, const TerminalSize& terminal);

  void info(const std::string& line);
  void warn(const std::string& line);
  /// The jobs that will run.
  void begin(std::size_t jobs, double expected_seconds);
  void start(std::size_t job, const std::string& label, const std::string& how, double expected_seconds);
  /// Frames done and wanted (0: not known yet), and what it said last.
  void progress(std::size_t job, int done, int total, const std::string& note);
  /// The job ended, for good or to be tried again; it is shown as `line`.
  void end(std::size_t job, bool for_good, bool failed, const std::string& line);
  /// Draws what changed; called often.
  void tick();
  /// Takes the drawn lines away.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  struct Running {
    std::size_t job;
    std::string label, note;
    int done = 0, total = 0;
    double expected_seconds;
    Clock::time_point start;
  };
  std::string line_of(const Running& one, std::size_t width) const;
  std::string whole_line() const;
  double share_done() const;
  void print(const std::string& line);
  void clear();
  void draw();

  Verbosity verbosity_;
  bool is_terminal_;
  std::size_t columns_, rows_;
  std::vector<Running> running_;
  std::size_t jobs_ = 0, ended_ = 0, failed_ = 0;
  double expected_seconds_ = 0, ended_seconds_ = 0;
  int drawn_ = 0;  ///< lines that stand below the last printed one
  Clock::time_point start_, last_tick_;
};

}  // namespace softreel
