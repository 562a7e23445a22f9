/// The command line of softreel: subcommands, options, help.
#pragma once

namespace softreel {

/// Parses the arguments and runs the subcommand. Returns the exit status; prints usage mistakes itself (status 2).
/// Throws Error for what goes wrong in the work.
int run_command_line(int argc, char** argv);

}  // namespace softreel
