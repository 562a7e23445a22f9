/// Text as words of a POSIX shell.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// The text as one word that any POSIX shell reads as exactly this text, whatever is in it but NUL. Two braces never
/// stand side by side in it: a template of Open Job Description would take them for a reference.
std::string shell_quoted(const std::string& text);

/// The words of a command, quoted where they need it, with blanks between.
std::string shell_command(const std::vector<std::string>& words);

}  // namespace softreel
