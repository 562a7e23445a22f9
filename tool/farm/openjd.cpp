#include "tool/farm/openjd.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "tool/cache/json_text.h"

namespace softreel {
namespace {

using nlohmann::ordered_json;

// Limits of the specification (2023-09): 1.1.1, 2.5.
constexpr std::size_t kMostOfName = 128;
constexpr std::size_t kMostOfParameter = 1024;

bool is_control(char c) {
  return static_cast<unsigned char>(c) < ' ' || c == 127;
}

bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

/// Of UTF-8 text that was cut at some byte: the last character goes, whole or not.
void leave_no_part_of_a_character(std::string& text) {
  while (!text.empty() && is_continuation(text.back())) text.pop_back();
  if (!text.empty() && static_cast<unsigned char>(text.back()) >= 0xC0U) text.pop_back();
}

/// The job's name is shown to people only: no control characters, no reference, not too long.
std::string title_of(const FarmShot& shot) {
  std::string title;
  for (const char c : shot.name) {
    if (title.size() + 1 >= kMostOfName) break;
    if (c == '{' && !title.empty() && title.back() == '{') title += ' ';
    title += is_control(c) ? '_' : c;
  }
  if (title.size() + 1 >= kMostOfName) leave_no_part_of_a_character(title);
  return title;
}

ordered_json path_parameter(const char* name, const char* type, const char* flow, const char* description,
                            const std::string& value) {
  if (value.size() > kMostOfParameter || std::any_of(value.begin(), value.end(), is_control))
    throw input_error(
        fmt::format("{}: an Open Job Description template cannot carry this path.\n  Accepted: at most {} characters, "
                    "none of them a "
                    "control character such as a line break. Choose another folder.",
                    value, kMostOfParameter));
  return {{"name", name},    {"type", "PATH"}, {"objectType", type}, {"dataFlow", flow}, {"description", description},
          {"default", value}};
}

ordered_json parameters_of(const FarmShot& shot) {
  return {path_parameter("Program", "FILE", "IN", "softreel, the build that made this template", shot.program),
          path_parameter("Shot", "FILE", "IN", "the shot", shot.shot),
          path_parameter("Output", "DIRECTORY", "INOUT", "pictures and movie; all nodes share it", shot.output),
          path_parameter("Cache", "DIRECTORY", "INOUT", "stored results; all nodes share it", shot.cache),
          path_parameter("Records", "DIRECTORY", "INOUT", "what tasks say of themselves, in the output folder",
                         shot.records),
          path_parameter("Directory", "DIRECTORY", "IN", "where relative paths in --set start from", shot.directory)};
}

/// The arguments of the script, which gives them names again.
constexpr const char* kNames = "program=$1\nshot=$2\noutput=$3\ncache=$4\nrecords=$5\ndirectory=$6\n";

ordered_json arguments_of(const FarmJob& job) {
  const std::string frames = job.step == FarmStep::Frames
                                 ? std::string("{{Task.Param.Frames}}")
                                 : fmt::format("{}-{}", job.tasks.front().first, job.tasks.front().last);
  return {"{{Task.File.Run}}", "{{Param.Program}}", "{{Param.Shot}}",      "{{Param.Output}}",
          "{{Param.Cache}}",   "{{Param.Records}}", "{{Param.Directory}}", frames};
}

std::string script_of(const FarmShot& shot, const FarmJob& job, const FarmNeeds& needs) {
  TaskVariables variables;
  variables.frames = "$7";
  variables.task = job.step == FarmStep::Frames ? "frames-$7" : task_name(job.step, job.tasks.front());
  variables.job = "''";
  variables.log = "$task.log";
  variables.threads = std::to_string(needs.cpus);
  variables.keeps_log = true;
  return "#!/bin/bash\n" + (kNames + set_assignment(shot, job.step)) + task_assignments(variables) +
         task_body(job.step);
}

ordered_json step_of(const FarmShot& shot, const std::vector<FarmJob>& jobs, std::size_t index,
                     const FarmNeeds& needs) {
  const FarmJob& job = jobs[index];
  ordered_json step{{"name", job_name(job)}};
  for (const std::size_t before : job.after) step["dependencies"].push_back({{"dependsOn", job_name(jobs[before])}});
  step["hostRequirements"] = {
      {"attributes", ordered_json::array({{{"name", "attr.worker.os.family"}, {"anyOf", {"linux"}}},
                                          {{"name", "attr.worker.cpu.arch"}, {"anyOf", {"x86_64"}}}})},
      {"amounts", ordered_json::array({{{"name", "amount.worker.vcpu"}, {"min", needs.cpus}},
                                       {{"name", "amount.worker.memory"},
                                        {"min", static_cast<long>(std::ceil(needs.bytes / (1024.0 * 1024.0)))}}})}};
  if (job.step == FarmStep::Frames) {
    ordered_json range = ordered_json::array();
    for (const FrameChunk& task : job.tasks) range.push_back(fmt::format("{}-{}", task.first, task.last));
    step["parameterSpace"]["taskParameterDefinitions"] =
        ordered_json::array({{{"name", "Frames"}, {"type", "STRING"}, {"range", range}}});
  }
  step["script"] = {{"actions",
                     {{"onRun",
                       {{"command", "bash"},
                        {"args", arguments_of(job)},
                        {"timeout", static_cast<long>(std::ceil(needs.seconds))},
                        // Time to finish a frame's files; what is finished is kept.
                        {"cancelation", {{"mode", "NOTIFY_THEN_TERMINATE"}, {"notifyPeriodInSeconds", 30}}}}}}},
                    {"embeddedFiles", ordered_json::array({{{"name", "Run"},
                                                            {"type", "TEXT"},
                                                            {"filename", job_name(job) + ".sh"},
                                                            {"data", script_of(shot, job, needs)}}})}};
  return step;
}

}  // namespace

std::string openjd_template(const FarmShot& shot, const std::vector<FarmJob>& jobs,
                            const std::vector<FarmNeeds>& needs) {
  ordered_json steps = ordered_json::array();
  for (std::size_t i = 0; i < jobs.size(); ++i) steps.push_back(step_of(shot, jobs, i, needs[i]));
  const ordered_json json{{"specificationVersion", "jobtemplate-2023-09"},
                          {"name", title_of(shot)},
                          {"description", "Made by softreel farm: simulate, frames, movie of one shot."},
                          {"parameterDefinitions", parameters_of(shot)},
                          {"steps", steps}};
  return record_text(json, 2, shot.shot, "an Open Job Description template");
}

}  // namespace softreel
