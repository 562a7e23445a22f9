/// Lines about a mesh that is only tried.
#pragma once

#include <string>
#include <vector>

#include "core/base/log.h"

namespace softreel {

/// Lines that wait until it is known whether their mesh is the one that is kept.
struct WaitingLog {
  std::vector<std::string> infos, warnings;

  Log sink() {
    return {[this](const std::string& line) { infos.push_back(line); },
            [this](const std::string& line) { warnings.push_back(line); }};
  }
  void pass_on(const Log& log) const {
    for (const std::string& line : infos) log.info(line);
    for (const std::string& line : warnings) log.warn(line);
  }
  /// fill(), whose lines come here; those that it has said go to `log` if it throws: no other mesh follows then.
  template <typename Fill>
  auto fill_or_pass_on(const Log& log, const Fill& fill) const {
    try {
      return fill();
    } catch (...) {
      pass_on(log);
      throw;
    }
  }
};

}  // namespace softreel
