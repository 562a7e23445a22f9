/// Completion of softreel's command lines in shells, from the table of commands.
///
/// Commands, options and fixed values are written into the scripts. What depends on a shot (fields, names of bodies,
/// positions in lists) and on the library (materials, presets) is asked of the program when the key is pressed.
#pragma once

#include <string>
#include <vector>

#include "tool/help/command_table.h"

namespace softreel {

/// Scripts to be sourced by the shell. They need nothing else: not the package bash-completion either.
std::string bash_completion(const std::vector<CommandText>& commands, const CommandText& program);
std::string zsh_completion(const std::vector<CommandText>& commands, const CommandText& program);
std::string fish_completion(const std::vector<CommandText>& commands, const CommandText& program);

/// Fields that --set may name, one on a line: with the names of the shot's bodies and materials and the positions of
/// its lists; of a shot that cannot be read, or none (empty path), those of the only body, and of lists their first
/// entry.
std::vector<std::string> settable_fields(const std::string& shot);

/// Values that a field takes, where they are few: choices, true and false, names of the shot's materials.
std::vector<std::string> field_values(const std::string& field, const std::string& shot);

}  // namespace softreel
