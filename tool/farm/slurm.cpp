#include "tool/farm/slurm.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

bool is_array(const FarmJob& job) {
  return job.step == FarmStep::Frames;
}

/// Bash statements that choose the frames of a task.
std::string frame_choice(const FarmJob& job) {
  std::string text = "chunks=(";
  for (std::size_t i = 0; i < job.tasks.size(); ++i)
    text += fmt::format("{}{}-{}", i == 0 ? "" : " ", job.tasks[i].first, job.tasks[i].last);
  return text + ")\n";
}

TaskVariables variables_of(const FarmJob& job, const FarmNeeds& needs) {
  TaskVariables variables;
  variables.threads = fmt::format("${{SLURM_CPUS_PER_TASK:-{}}}", needs.cpus);
  if (is_array(job)) {
    variables.frames = "${chunks[$SLURM_ARRAY_TASK_ID]}";
    variables.task = fmt::format("{}-{}", step_name(job.step), variables.frames);
    variables.job = "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID";
    variables.log = slurm_log(job, variables.job);
  } else {
    variables.frames = "${chunks[0]}";
    variables.task = task_name(job.step, job.tasks.front());
    variables.job = "$SLURM_JOB_ID";
    variables.log = slurm_log(job, variables.job);
  }
  return variables;
}

/// As sbatch reads names of logs: % starts a field, and a \ would switch fields off.
std::string log_pattern(const FarmShot& shot, const FarmJob& job) {
  std::string pattern;
  for (const char c : log_folder(shot)) pattern += c == '%' ? std::string("%%") : std::string(1, c);
  if (pattern.find('\\') != std::string::npos)
    throw input_error(
        fmt::format("{}: Slurm cannot write logs to a folder with a backslash in its name.\n  Accepted: any other "
                    "character. Choose "
                    "another folder with --output.",
                    log_folder(shot)));
  return pattern + "/" + slurm_log(job, is_array(job) ? "%A_%a" : "%j");
}

/// Names of jobs are shown in lists: what would break a line is left out.
std::string shown_name(const FarmShot& shot, const FarmJob& job) {
  std::string name = shot.name + "-" + step_name(job.step);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }, '_');
  return name;
}

/// Whether sbatch reads a word, up to a =, as --dependency: also by a beginning that is of no other option.
bool is_dependency(const std::string& name) {
  return name.size() >= 5 && std::string("--dependency").starts_with(name);
}

/// The further arguments of a user, and apart from them what the user's jobs are to wait for.
struct UserArguments {
  std::vector<std::string> dependencies, others;
};

UserArguments sort_out(const std::vector<std::string>& given) {
  UserArguments sorted;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string name = given[i].substr(0, given[i].find('='));
    const bool is_last = i + 1 == given.size();
    if (is_dependency(name) && name != given[i])
      sorted.dependencies.push_back(given[i].substr(name.size() + 1));
    else if ((is_dependency(given[i]) || given[i] == "-d") && !is_last)
      sorted.dependencies.push_back(given[++i]);
    else if (given[i].starts_with("-d") && given[i] != "-d")
      sorted.dependencies.push_back(given[i].substr(2));
    else
      sorted.others.push_back(given[i]);
  }
  for (const std::string& dependency : sorted.dependencies)
    if (dependency.find('?') != std::string::npos)
      throw input_error(
          fmt::format("--sbatch: the dependency \"{}\" asks for any of its conditions, and the jobs of a shot wait for "
                      "all of theirs.\n  Accepted: conditions with commas between them, which must all hold.",
                      dependency));
  return sorted;
}

/// What a job waits for: the jobs of its shot, and what the user says. sbatch takes the last --dependency only.
std::vector<std::string> dependency_arguments(const std::vector<std::string>& after,
                                              const std::vector<std::string>& users) {
  if (after.empty() && users.empty()) return {};
  std::string text;
  if (!after.empty()) {
    text = "afterok";
    for (const std::string& one : after) text += ":" + one;
  }
  for (const std::string& one : users) text += (text.empty() ? "" : ",") + one;
  std::vector<std::string> arguments{"--dependency=" + text};
  if (!after.empty()) arguments.emplace_back("--kill-on-invalid-dep=yes");  // else it would wait for ever for a failed
  return arguments;
}

}  // namespace

std::string slurm_task(const FarmJob& job, const std::string& job_number, std::size_t task) {
  return is_array(job) ? fmt::format("{}_{}", job_number, task) : job_number;
}

std::string slurm_log(const FarmJob& job, const std::string& slurm_task) {
  return fmt::format("{}-{}.log", step_name(job.step), slurm_task);
}

std::string slurm_script(const FarmShot& shot, const FarmJob& job, const FarmNeeds& needs) {
  return "#!/bin/bash\n# Made by softreel farm; made again at every submission.\n" + shot_assignments(shot) +
         set_assignment(shot, job.step) + frame_choice(job) + task_assignments(variables_of(job, needs)) +
         task_body(job.step);
}

std::vector<std::string> sbatch_command(const FarmShot& shot, const FarmJob& job, const FarmNeeds& needs,
                                        const FarmSettings& settings, const std::vector<std::string>& after,
                                        const std::string& script_path) {
  const auto minutes = static_cast<long>(std::ceil(needs.seconds / 60));
  const auto mebibytes = static_cast<long>(std::ceil(needs.bytes / (1024.0 * 1024.0)));
  std::vector<std::string> command{"sbatch", "--parsable", "--job-name=" + shown_name(shot, job),
                                   // A node that dies gives the task back; what it had finished is in the cache.
                                   "--requeue", "--open-mode=append", "--output=" + log_pattern(shot, job),
                                   fmt::format("--cpus-per-task={}", needs.cpus), fmt::format("--mem={}M", mebibytes),
                                   fmt::format("--time={}", minutes)};
  if (is_array(job)) command.push_back(fmt::format("--array=0-{}", job.tasks.size() - 1));
  const UserArguments users = sort_out(settings.sbatch);
  for (std::string& one : dependency_arguments(after, users.dependencies)) command.push_back(std::move(one));
  if (!settings.partition.empty()) command.push_back("--partition=" + settings.partition);
  if (!settings.account.empty()) command.push_back("--account=" + settings.account);
  if (!settings.constraint.empty()) command.push_back("--constraint=" + settings.constraint);
  command.insert(command.end(), users.others.begin(), users.others.end());
  command.push_back(script_path);
  return command;
}

std::string submitted_job(const std::string& said) {
  // A line with the number, or with NUMBER;CLUSTER; warnings may stand before it.
  std::string number;
  for (std::size_t begin = 0; begin < said.size();) {
    const std::size_t end = std::min(said.find('\n', begin), said.size());
    const std::string line = said.substr(begin, end - begin);
    const std::string word = line.substr(0, line.find(';'));
    if (!word.empty() && word.find_first_not_of("0123456789") == std::string::npos) number = word;
    begin = end + 1;
  }
  if (number.empty())
    throw work_error(fmt::format("sbatch named no job; it said: {}", said.empty() ? "nothing" : said));
  return number;
}

}  // namespace softreel
