/// Bash, a stand-in for softreel that remembers its arguments, and a shot with names that no script may stumble over.
#pragma once

#include <string>
#include <vector>

#include "tool/farm/task_script.h"

namespace softreel::testing {

/// Names and values in which every character that a shell or a template knows stands somewhere.
inline const std::string kNasty = "it's \"a\" $(touch boom) `x` {{Param.Shot}} }}\\n\n\t*;&|<>!#~ \xC3\xA4 ";

struct ShellOutcome {
  int status = 0;
  std::string said;  ///< standard output and error
};

/// Runs a script with bash and these positional arguments; environment: "NAME=value" words.
ShellOutcome run_bash(const std::string& script, const std::vector<std::string>& arguments = {},
                      const std::vector<std::string>& environment = {});

/// A folder of its own for a test; `name` may be anything that a file may be called.
std::string farm_folder(const std::string& name);

/// A shot whose folders are there, with tokens, and whose program is the stand-in: it writes its arguments, one after
/// another with a NUL after each, to PROGRAM.arguments, and ends with the status in PROGRAM.status, 0 if there is none.
FarmShot stand_in_shot(const std::string& folder);

/// The stand-in's arguments when it ran last; empty if it did not.
std::vector<std::string> arguments_of(const FarmShot& shot);

/// The argument after this one; empty if there is none.
std::string argument_after(const std::vector<std::string>& arguments, const std::string& name);

std::string text_of(const std::string& path);
void write(const std::string& path, const std::string& text);

}  // namespace softreel::testing
