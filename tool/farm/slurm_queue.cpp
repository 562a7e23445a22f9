#include "tool/farm/slurm_queue.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/ranges.h>

namespace softreel {
namespace {

constexpr char kSeparator = '|';

constexpr std::array<std::string_view, 13> kEnded{
    "BOOT_FAIL", "CANCELLED", "COMPLETED",    "DEADLINE", "FAILED",  "NODE_FAIL",    "OUT_OF_MEMORY",
    "PREEMPTED", "REVOKED",   "SPECIAL_EXIT", "STOPPED",  "TIMEOUT", "LAUNCH_FAILED"};

/// Reasons that end only when somebody changes the job or the cluster. Those of busy resources, priorities and limits
/// on what runs at the same time are not among them.
constexpr std::array<std::string_view, 17> kHopeless{"AccountNotAllowed",
                                                     "AssocMaxCpuPerJobLimit",
                                                     "AssocMaxMemPerJob",
                                                     "AssocMaxWallDurationPerJobLimit",
                                                     "BadConstraints",
                                                     "DependencyNeverSatisfied",
                                                     "InvalidAccount",
                                                     "InvalidQOS",
                                                     "JobHeldAdmin",
                                                     "JobHeldUser",
                                                     "PartitionDown",
                                                     "PartitionInactive",
                                                     "PartitionNodeLimit",
                                                     "PartitionTimeLimit",
                                                     "QOSMaxCpuPerJobLimit",
                                                     "QOSMaxMemoryPerJob",
                                                     "QOSMaxWallDurationPerJobLimit"};

template <std::size_t N>
bool contains(const std::array<std::string_view, N>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::vector<std::string> squeue_command(const std::set<unsigned>& users) {
  return {"squeue",
          "--noheader",
          "--array",
          "--states=all",
          fmt::format("--user={}", fmt::join(users, ",")),
          "--format=%i|%T|%N|%r"};
}

Queue parse_queue(const std::string& said) {
  Queue queue;
  for (std::size_t begin = 0; begin < said.size();) {
    const std::size_t end = std::min(said.find('\n', begin), said.size());
    std::array<std::string, 4> fields;
    std::size_t at = begin, count = 0;
    for (; count < fields.size() && at <= end; ++count) {
      const std::size_t stop = count + 1 < fields.size() ? std::min(said.find(kSeparator, at), end) : end;
      fields[count] = said.substr(at, stop - at);
      at = stop + 1;
    }
    if (count == fields.size()) queue[fields[0]] = {fields[1], fields[2], fields[3]};
    begin = end + 1;
  }
  return queue;
}

bool is_live(const QueueEntry& entry) {
  return !contains(kEnded, entry.state);
}

bool is_hopeless(const QueueEntry& entry) {
  // "launch failed requeued held" and the like have blanks instead of a word.
  return entry.state == "PENDING" &&
         (contains(kHopeless, entry.reason) || entry.reason.find("requeued held") != std::string::npos);
}

}  // namespace softreel
