/// The machine and the versions that a report was made with.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace softreel::bench {

/// Name and value: processor, cores, memory, system, versions, load, date.
std::vector<std::pair<std::string, std::string>> describe_machine();

}  // namespace softreel::bench
