/// Other programs, started without a shell.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// Runs arguments[0] (found on PATH) with the rest and waits for it. Its standard output and error go to `log_path`, or
/// to ours if that is empty. Returns its exit status, 128 + signal if it was killed, -1 if it could not be started.
int run_process(std::vector<std::string> arguments, const std::string& log_path);

}  // namespace softreel
