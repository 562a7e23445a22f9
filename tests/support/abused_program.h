/// Runs the softreel program while it is abused: killed, interrupted, on a full or read-only disk, under a mad clock.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/support/program.h"

namespace softreel::testing {

/// Variables of tests/support/abuse/abuse.h without ABUSE_; none: the program is left in peace.
using Abuse = std::map<std::string, std::string>;

/// A program that runs beside the test. It is killed if the test forgets it.
class RunningProgram {
 public:
  /// `arguments` start with the program; the first may be "softreel".
  RunningProgram(const std::string& name, std::vector<std::string> arguments, const Abuse& abuse = {});
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  bool has_ended();
  /// What it has said so far.
  std::string err() const;
  Outcome wait();

 private:
  std::string folder_;
  pid_t pid_ = -1;
  bool ended_ = false;
  int status_ = 0;
};

/// The parts of a text between blanks.
std::vector<std::string> words_of(const std::string& text);

/// Runs `softreel ARGUMENTS...`, split at blanks, to its end.
Outcome run_abused(const std::string& arguments, const Abuse& abuse);

/// Calls and bytes that a run counted under its roots.
struct Counted {
  std::uint64_t calls = 0, bytes = 0;
};
Counted read_counts(const std::string& count_file);

/// Processes that ended programs of this test left running (they become its own children). Reaps those that ended.
/// Call `adopt_orphans` before the first program starts.
void adopt_orphans();
bool has_living_orphan();
/// Waits until none is left; false if one is after a minute.
bool wait_for_orphans();

/// The lines of a text that hold `part`.
std::vector<std::string> lines_with(const std::string& text, const std::string& part);

}  // namespace softreel::testing
