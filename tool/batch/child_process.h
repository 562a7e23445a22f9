/// A program that runs beside this one: what it writes is read as it comes, and it never outlives us.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace softreel {

/// How a program ended.
struct ProcessEnd {
  int status = 0;          ///< exit status, if no signal ended it
  int signal = 0;          ///< that ended it; 0: none
  double cpu_seconds = 0;  ///< of it and of what it waited for
  double peak_bytes = 0;   ///< most memory that was resident, of it or of one that it waited for
};

/// "signal 9 (SIGKILL)"
std::string signal_text(int signal);

/// Start all children from one thread, which outlives them: the kernel ends a child when the thread that started it
/// ends. They get no signals from our terminal, and are the first to go when the machine runs out of memory.
class ChildProcess {
 public:
  /// Starts arguments[0], a path, with the rest. Throws work_error if that fails.
  explicit ChildProcess(std::vector<std::string> arguments);
  /// Kills it if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;

  /// Reads what there is, without waiting; once the program has ended, returns how.
  std::optional<ProcessEnd> poll();

  /// All of its standard output so far.
  const std::string& out() const { return out_.text; }
  /// Its standard error so far; of very much the first and the last part.
  const std::string& err() const { return err_.text; }

  /// Waits until one of the children writes something or ends, or for this long.
  static void wait_for_any(const std::vector<ChildProcess*>& children, int milliseconds);

 private:
  struct Pipe {
    std::size_t most;  ///< bytes to keep: of more, the middle goes
    int descriptor = -1;
    std::string text = {};
    void read_what_is_there();
    void close();
  };
  void start(std::vector<char*>& arguments, int out_end, int err_end);

  pid_t pid_ = -1;
  Pipe out_{std::string::npos}, err_{std::size_t{8} << 20U};
  std::optional<ProcessEnd> end_;
};

}  // namespace softreel
