/// What a running softreel says on standard error, read by another program.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace softreel {

/// Follows the text as it grows.
class JobMessages {
 public:
  /// all: what was said so far; grows from call to call.
  void read(const std::string& all);

  /// Frames done and wanted; 0 before the first.
  int done() const { return done_; }
  int total() const { return total_; }
  /// The last line that was said, in short; empty before the first.
  const std::string& note() const { return note_; }

 private:
  void read_line(const std::string& line);

  std::size_t at_ = 0;
  int done_ = 0, total_ = 0;
  std::string note_;
};

/// The warnings in what a program said, each once, without their first word.
std::vector<std::string> warnings_in(const std::string& said);

/// The message that a program ended with, without its name; if there is none, the last lines that it said.
std::string closing_message(const std::string& said);

}  // namespace softreel
