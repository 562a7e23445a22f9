#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tool/cache/cache_use.h"
#include "tool/cache/json_text.h"
#include "tool/commands/commands.h"
#include "tool/stages/shot_status.h"

namespace softreel {
namespace {

const char* word_of(Condition condition) {
  switch (condition) {
    case Condition::Done:
      return "done";
    case Condition::Stale:
      return "stale";
    case Condition::Missing:
      return "missing";
    case Condition::Damaged:
      return "damaged";
    case Condition::NotNeeded:
      return "not needed";
  }
  return "";
}

std::string change_text(const StaleReason& reason) {
  return fmt::format("{}: {} -> {}", reason.field, reason.before.empty() ? "(not there)" : reason.before,
                     reason.after.empty() ? "(not there)" : reason.after);
}

void print(const StageStatus& status) {
  std::string line;
  for (const auto& [condition, frames] : status.frames) {
    line += line.empty() ? "" : "; ";
    line += status.per_frame ? fmt::format("{} {}", word_of(condition), frame_ranges(frames)) : word_of(condition);
  }
  std::printf("  %-11s %-10s %s\n", status.stage.c_str(), status.what.c_str(), line.c_str());
  for (const auto& [reason, frames] : status.reasons)
    std::printf("    because of %s%s\n", change_text(reason).c_str(),
                status.per_frame && frames != status.frames.at(Condition::Stale)
                    ? fmt::format(" (frames {})", frame_ranges(frames)).c_str()
                    : "");
  if (!status.cause.empty()) std::printf("    because %s\n", status.cause.c_str());
}

nlohmann::ordered_json to_json(const StageStatus& status) {
  nlohmann::ordered_json json{{"stage", status.stage}, {"what", status.what}};
  for (const auto& [condition, frames] : status.frames) {
    if (status.per_frame)
      json[word_of(condition)] = frames;
    else
      json["condition"] = word_of(condition);
  }
  json["because"] = nlohmann::ordered_json::array();
  for (const auto& [reason, frames] : status.reasons)
    json["because"].push_back(
        {{"field", reason.field}, {"before", reason.before}, {"after", reason.after}, {"frames", frames}});
  if (!status.cause.empty()) json["cause"] = status.cause;
  return json;
}

}  // namespace

int run_status(const StatusOptions& options) {
  ShotOptions silent = options.shot;
  silent.quiet = true;
  Session session(silent);
  const Shot& shot = session.shot();
  Outputs outputs(shot.output.directory, shot.settings.name, session.context().log);
  const std::vector<StageStatus> statuses = find_status(shot, outputs, session.context());
  const bool done = std::all_of(statuses.begin(), statuses.end(), [](const StageStatus& s) { return s.done(); });
  const double bytes = cache_size(session.context().cache);
  const double limit = session.cache_limit();
  if (options.shot.json) {
    nlohmann::ordered_json stages = nlohmann::ordered_json::array();
    for (const StageStatus& status : statuses) stages.push_back(to_json(status));
    const nlohmann::ordered_json json{
        {"shot", shot.path},         {"output", shot.output.directory},           {"done", done},
        {"stages", stages},          {"cache", session.context().cache.folder()}, {"cache_bytes", bytes},
        {"cache_limit_bytes", limit}};
    std::printf("%s\n", json_text(json).c_str());
  } else {
    std::printf("%s (%s) in %s: %s\n", shot.settings.name.c_str(), shot.path.c_str(), shot.output.directory.c_str(),
                done ? "all done" : "not all done");
    for (const StageStatus& status : statuses) print(status);
    std::printf("  cache       %s in %s%s\n", format_bytes(bytes).c_str(), session.context().cache.folder().c_str(),
                limit > 0 ? fmt::format(", limit {}", format_bytes(limit)).c_str() : ", no limit");
  }
  return options.exit_code && !done ? 1 : 0;
}

}  // namespace softreel
