/// Other programs, started without a shell.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace softreel {

/// Runs arguments[0] (found on PATH) with the rest and waits for it. Its standard output and error go to `said`, or to
/// ours if that is null. Returns its exit status, 128 + signal if it was killed, -errno if it could not be started.
/// cancelled: if not null and true it is not started, which counts as killed by SIGTERM; whoever sets it and then calls
/// end_processes misses none.
int run_process(std::vector<std::string> arguments, std::string* said, const std::atomic<bool>* cancelled = nullptr);

/// Why a program was not started, or not found by a shell: what follows its name, by what run_process returned; empty
/// if it ran.
std::string why_not_started(int status);

/// Asks the programs that run_process waits for to end (SIGTERM). Callable from any thread.
void end_processes();

}  // namespace softreel
