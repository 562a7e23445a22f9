#include "tool/farm/farm_settings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

constexpr double kTaskSeconds = 300;
constexpr int kLeastTasks = 8;
constexpr double kMebibyte = 1024.0 * 1024.0;

/// The whole text as a number of digits only; -1 for anything else.
long whole_number(std::string_view text) {
  long value = 0;
  const bool digits =
      !text.empty() && text.size() <= 9 && text.find_first_not_of("0123456789") == std::string_view::npos;
  if (!digits) return -1;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// The fields between colons; -1 for what is no number.
std::vector<long> colon_fields(std::string_view text) {
  std::vector<long> fields;
  while (true) {
    const std::size_t colon = text.find(':');
    fields.push_back(whole_number(text.substr(0, colon)));
    if (colon == std::string_view::npos) return fields;
    text.remove_prefix(colon + 1);
  }
}

void take(std::string& kept, const std::string& given) {
  if (!given.empty()) kept = given;
}

/// In the unit that sbatch takes without loss: whole mebibytes, rounded up to quarters of a gibibyte.
double rounded_memory(double bytes) {
  return std::ceil(bytes / (256 * kMebibyte)) * 256 * kMebibyte;
}

double expected_seconds(const FarmJob& job, const FarmEstimate& estimate) {
  int longest = 0;
  for (const FrameChunk& task : job.tasks) longest = std::max(longest, task.count());
  switch (job.step) {
    case FarmStep::Simulate:
      return estimate.fill_seconds + estimate.simulate_seconds;
    case FarmStep::Frames:
      return estimate.fill_seconds + longest * estimate.frame_seconds;
    case FarmStep::Movie:
      return longest;  // encoding takes a fraction of a second a frame
  }
  return 0;
}

}  // namespace

FarmSettings merged(FarmSettings before, const FarmSettings& given) {
  take(before.name, given.name);
  if (given.chunk > 0) before.chunk = given.chunk;
  if (given.cpus > 0) before.cpus = given.cpus;
  take(before.memory, given.memory);
  take(before.time, given.time);
  take(before.partition, given.partition);
  take(before.account, given.account);
  take(before.constraint, given.constraint);
  take(before.program, given.program);
  if (!given.sbatch.empty()) before.sbatch = given.sbatch;
  return before;
}

double parse_memory(const std::string& text) {
  constexpr std::string_view kUnits = "KMGT";
  std::string_view digits = text;
  double unit = kMebibyte;
  if (!digits.empty())
    if (const std::size_t power = kUnits.find(digits.back()); power != std::string_view::npos) {
      unit = std::pow(1024.0, static_cast<double>(power + 1));
      digits.remove_suffix(1);
    }
  const long value = whole_number(digits);
  if (value <= 0)
    throw input_error(
        fmt::format("--memory: \"{}\" is no amount of memory.\n  Accepted: a whole number with K, M, G or T, such as "
                    "12G; without a "
                    "letter megabytes.",
                    text));
  return static_cast<double>(value) * unit;
}

double parse_time(const std::string& text) {
  const std::size_t dash = text.find('-');
  const bool has_days = dash != std::string::npos;
  const long days = has_days ? whole_number(std::string_view(text).substr(0, dash)) : 0;
  const std::vector<long> fields = colon_fields(std::string_view(text).substr(has_days ? dash + 1 : 0));
  const bool sound =
      days >= 0 && fields.size() <= 3 && std::all_of(fields.begin(), fields.end(), [](long f) { return f >= 0; });
  // What the first field counts depends on how many there are.
  constexpr std::array<double, 3> kFromHours{3600, 60, 1}, kFromMinutes{60, 1, 0};
  const auto& units = has_days || fields.size() == 3 ? kFromHours : kFromMinutes;
  double seconds = 86400.0 * static_cast<double>(days);
  for (std::size_t i = 0; sound && i < fields.size(); ++i) seconds += units[i] * static_cast<double>(fields[i]);
  if (!sound || seconds <= 0)
    throw input_error(fmt::format(
        "--time: \"{}\" is no time limit.\n  Accepted: MINUTES, MINUTES:SECONDS, HOURS:MINUTES:SECONDS, DAYS-HOURS or "
        "DAYS-HOURS:MINUTES:SECONDS, above 0; such as 90 or 1:30:00.",
        text));
  return seconds;
}

int default_chunk(const FarmEstimate& estimate, int frames) {
  const int for_all_nodes = std::max(1, (frames + kLeastTasks - 1) / kLeastTasks);
  if (estimate.frame_seconds * for_all_nodes <= kTaskSeconds) return for_all_nodes;
  return std::max(1, static_cast<int>(kTaskSeconds / estimate.frame_seconds));
}

FarmNeeds needs_of(const FarmJob& job, const FarmEstimate& estimate, const FarmSettings& settings) {
  FarmNeeds needs;
  needs.cpus = settings.cpus > 0 ? settings.cpus : kDefaultTaskCpus;
  needs.bytes =
      settings.memory.empty() ? rounded_memory(2 * estimate.bytes + 1024 * kMebibyte) : parse_memory(settings.memory);
  needs.seconds =
      settings.time.empty() ? 60 * std::ceil(30 + expected_seconds(job, estimate) / 10) : parse_time(settings.time);
  return needs;
}

}  // namespace softreel
