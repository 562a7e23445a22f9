/// What this machine has for a batch to use.
#pragma once

#include <string>

namespace softreel {

/// Processors that this process may run on.
int usable_processors();

/// Memory that can be had without swapping, bytes: the kernel's MemAvailable, or what the limits of this process's
/// control groups (v2) leave if that is less. 0 if the system does not say.
double available_memory();

/// The path of the running program.
std::string program_path();

}  // namespace softreel
