/// What this machine has for a batch to use.
#pragma once

#include <string>

namespace softreel {

/// Processors that this process may run on.
int usable_processors();

/// Memory that can be had without swapping, bytes: the kernel's MemAvailable, or what the limits of this process's
/// control groups leave if that is less; infinite if the system does not say.
double available_memory();

/// What the limits of the groups named in the file `membership` (of the form of /proc/self/cgroup) and of those above
/// them leave, bytes; `root`: where the groups' files are, those of version 1 in its folder "memory". Files in memory
/// count as free. Infinite without limits.
double left_by_control_groups(const std::string& membership, const std::string& root);

/// The path of the running program.
std::string program_path();

}  // namespace softreel
