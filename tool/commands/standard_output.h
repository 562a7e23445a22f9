/// What the program printed, and whether it arrived.
#pragma once

namespace softreel {

/// Called last: the exit status of the program, which is not 0 if standard output did not take all that was printed.
/// That is said, unless the reader went away, as `head` does.
int status_after_output(int status);

}  // namespace softreel
