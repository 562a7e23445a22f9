/// Ctrl-C, SIGTERM and SIGHUP: the work stops at its next step, and the program ends within a second whatever it is
/// doing, or within five if it has to wait for processes of its own.
#pragma once

#include <atomic>

namespace softreel {

/// Set once the user has asked to stop; stages ask for it between steps, parallel loops between chunks.
std::atomic<bool>& cancellation();

/// Watches for SIGINT, SIGTERM and SIGHUP on a thread of its own, but for those that the program was started to ignore.
/// What does not stop by itself in time (a library that reads a
/// large file, say) is ended with status 130: files are written so that this loses nothing but the frame in work. A
/// second signal ends the program at once. Called once, before other threads are made.
void watch_for_interruption();

/// What the program says as it ends: the usual words, unless the command keeps nothing.
const char* interruption_message(const char* usual);

/// This command writes its one result at its end: once interrupted it says so, rather than that it can go on.
void keep_nothing_when_interrupted();

/// This command runs others of the same program, and reports what became of them: once interrupted it is given the time
/// to see them end, a few seconds at most.
void wait_for_children_when_interrupted();

}  // namespace softreel
