#include "tool/batch/batch_result.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "tool/batch/child_process.h"
#include "tool/cache/json_text.h"

namespace softreel {
namespace {

using nlohmann::ordered_json;

ordered_json parsed(const std::string& text) {
  ordered_json json = ordered_json::parse(text, nullptr, false);
  return json.is_object() ? json : ordered_json::object();
}

/// "simulate/solve" is part of "simulate", whether that has an entry of its own or not.
std::vector<StageSeconds> stages_from(const ordered_json& stages) {
  std::vector<StageSeconds> sums;
  for (const auto& [name, entry] : stages.items()) {
    const std::string stage = name.substr(0, name.find('/'));
    const double seconds = entry.value("seconds", 0.0);
    const auto sum = std::find_if(sums.begin(), sums.end(), [&](const auto& one) { return one.stage == stage; });
    if (sum == sums.end())
      sums.push_back({stage, seconds});
    else if (stages.contains(stage) && name != stage)
      continue;  // its time is in that of the whole stage
    else
      sum->seconds += seconds;
  }
  std::sort(sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.seconds > b.seconds; });
  return sums;
}

ordered_json to_json(const JobPlan& plan) {
  if (!plan.known) return nullptr;
  return {{"complete", plan.complete},
          {"frames", {plan.first_frame, plan.last_frame}},
          {"tetrahedra", plan.tets},
          {"simulate", {{"missing", plan.simulate_missing}, {"of", plan.simulate_of}}},
          {"trace", {{"missing", plan.trace_missing}, {"there", plan.trace_there}, {"of", plan.trace_of}}},
          {"bytes", plan.bytes},
          {"seconds", plan.seconds}};
}

ordered_json to_json(const BatchJob& job, const JobResult& result) {
  ordered_json json{{"name", job.name},
                    {"variant", job.variant},
                    {"shot", job.shot},
                    {"set", job.sets},
                    {"output", job.folder},
                    {"command", job.command_line()},
                    {"state", word_of(result.state)},
                    {"status", result.status},
                    {"signal", result.signal},
                    {"attempts", result.attempts},
                    {"threads", result.threads},
                    {"alone", result.alone},
                    {"seconds", result.seconds},
                    {"cpu_seconds", result.cpu_seconds},
                    {"peak_bytes", result.peak_bytes},
                    {"expected", to_json(result.plan)},
                    {"simulated", result.facts.simulated},
                    {"traced", result.facts.traced},
                    {"message", result.message},
                    {"warnings", result.warnings},
                    {"skipped", result.facts.skipped},
                    {"made", result.facts.made}};
  json["stages"] = ordered_json::object();
  for (const StageSeconds& stage : result.facts.stages) json["stages"][stage.stage] = stage.seconds;
  return json;
}

}  // namespace

const char* word_of(JobState state) {
  switch (state) {
    case JobState::Waiting:
      return "waiting";
    case JobState::Done:
      return "done";
    case JobState::UpToDate:
      return "up to date";
    case JobState::Failed:
      return "failed";
    case JobState::Interrupted:
      return "interrupted";
    case JobState::NotStarted:
      return "not started";
  }
  return "";
}

int BatchResult::count(JobState state) const {
  return static_cast<int>(
      std::count_if(results.begin(), results.end(), [&](const JobResult& one) { return one.state == state; }));
}

JobPlan plan_from_json(const std::string& text) {
  const ordered_json json = parsed(text);
  JobPlan plan;
  try {
    plan.complete = json.at("complete").get<bool>();
    plan.first_frame = json.at("frames").at(0).get<int>();
    plan.last_frame = json.at("frames").at(1).get<int>();
    plan.tets = json.at("tetrahedra").get<double>();
    plan.simulate_missing = json.at("simulate").at("missing").get<int>();
    plan.simulate_of = json.at("simulate").at("of").get<int>();
    plan.trace_missing = json.at("trace").at("missing").get<int>();
    plan.trace_there = json.at("trace").at("there").get<int>();
    plan.trace_of = json.at("trace").at("of").get<int>();
    plan.bytes = json.at("expected").at("bytes").get<double>();
    plan.seconds = json.at("expected").at("seconds").get<double>();
    plan.known = true;
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  return plan;
}

RunFacts facts_from_json(const std::string& text) {
  const ordered_json json = parsed(text);
  RunFacts facts;
  try {
    if (json.contains("stages")) facts.stages = stages_from(json["stages"]);
    if (json.contains("energies")) facts.energies = energies_from_json(json_text(json["energies"]));
    if (json.contains("made")) facts.made = json["made"].get<std::vector<std::string>>();
    if (json.contains("skipped")) facts.skipped = json["skipped"].get<std::vector<std::string>>();
    if (json.contains("simulation")) facts.simulated = json["simulation"].value("computed", 0);
    if (json.contains("pictures")) facts.traced = json["pictures"].value("traced", 0);
  } catch (const nlohmann::json::exception&) {
    return facts;  // of another program: what could be read is shown
  }
  return facts;
}

std::string to_json(const BatchResult& batch) {
  ordered_json jobs = ordered_json::array();
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) jobs.push_back(to_json(batch.jobs[i], batch.results[i]));
  ordered_json counts = ordered_json::object();
  for (const JobState state : {JobState::Waiting, JobState::Done, JobState::UpToDate, JobState::Failed,
                               JobState::Interrupted, JobState::NotStarted})
    if (const int count = batch.count(state); count > 0) counts[word_of(state)] = count;
  return json_text(ordered_json{{"command", "batch"},
                                {"command_line", batch.command},
                                {"seconds", batch.seconds},
                                {"jobs_at_one_time", batch.jobs_at_one_time},
                                {"threads", batch.threads},
                                {"memory_bytes", batch.bytes},
                                {"interrupted", batch.interrupted},
                                {"counts", counts},
                                {"jobs", jobs}});
}

}  // namespace softreel
