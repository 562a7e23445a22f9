/// Information and warnings on their way to whoever shows them; passed by reference, never global.
#pragma once

#include <functional>
#include <string>
#include <utility>

namespace softreel {

/// Sinks for one-line messages. An empty sink drops its lines. The sinks must be safe to call from any thread.
struct Log {
  std::function<void(const std::string&)> info_sink;
  std::function<void(const std::string&)> warning_sink;

  void info(const std::string& line) const {
    if (info_sink) info_sink(line);
  }
  void warn(const std::string& line) const {
    if (warning_sink) warning_sink(line);
  }
};

}  // namespace softreel
