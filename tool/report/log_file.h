/// The file of --log-file: every message of the program, whatever standard error shows.
#pragma once

#include <cstdio>
#include <mutex>
#include <string>

#include "tool/report/console.h"

namespace softreel {

/// A file that lines are added to, each at once and whole, so that several programs can share it. Thread-safe.
class LogFile {
 public:
  LogFile() = default;
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  /// Throws work_error naming the file if it cannot be opened. What cannot be written later is not: a full disk must
  /// not stop work that needs none.
  void open(const std::string& path);
  /// "2026-11-28T13:11:33 1234 warning: LINE"; nothing where no file is open.
  void add(LogLevel level, const std::string& line);
  /// As it was opened; empty: no file is open.
  const std::string& path() const { return path_; }

 private:
  std::mutex mutex_;
  std::FILE* file_ = nullptr;
  std::string path_;  ///< changes in `open` only, which comes before all else
};

/// That of the process.
LogFile& log_file();

}  // namespace softreel
