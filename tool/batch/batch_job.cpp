#include "tool/batch/batch_job.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/batch/sweep.h"
#include "tool/farm/shell_text.h"
#include "tool/shot/shot_load.h"

namespace softreel {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostJobs = 10000;

/// The shot with the overrides of all jobs; nothing, and why, if its file cannot be read even without them.
std::optional<Shot> read_shot(const std::string& path, const std::vector<Override>& overrides, std::string& problem) {
  try {
    return load_shot(path, overrides);
  } catch (const Error& wrong_with_them) {
    try {
      load_shot(path, {});
    } catch (const Error& error) {
      problem = wrong_with_them.what();
      return std::nullopt;
    }
    throw;  // the file is sound: an override is wrong
  }
}

/// The shot of one variant.
Shot read_variant(const std::string& path, std::vector<Override> overrides, const Variant& variant) {
  overrides.insert(overrides.end(), variant.values.begin(), variant.values.end());
  try {
    return load_shot(path, overrides);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}\n  {} was not run, nor any other job.", error.what(), path));
  }
}

std::vector<std::string> render_arguments(const BatchRequest& request, const BatchJob& job, const std::string& cache,
                                          double cache_limit_gb) {
  std::vector<std::string> arguments{"render", job.shot};
  const auto add = [&](const std::string& option, const std::string& value) {
    if (!value.empty()) arguments.insert(arguments.end(), {option, value});
  };
  for (const std::string& set : job.sets) add("--set", set);
  add("--frames", request.frames);
  if (!job.variant.empty() || !request.output.empty()) add("--output", job.folder);
  add("--cache", cache);
  if (cache_limit_gb >= 0) add("--cache-limit", fmt::format("{}", cache_limit_gb));
  return arguments;
}

BatchJob make_job(const BatchRequest& request, const std::string& path, const Shot& shot, const Variant& variant) {
  BatchJob job;
  job.shot = path;
  job.name = shot.settings.name;
  job.variant = variant.name;
  job.sets = request.sets;
  for (const Override& one : variant.values) job.swept.push_back(one.path + "=" + one.value);
  job.sets.insert(job.sets.end(), job.swept.begin(), job.swept.end());
  const fs::path base(request.output.empty() ? shot.output.directory : request.output);
  job.folder = (variant.name.empty() ? base : base / variant.name).string();
  std::string cache = request.cache;
  double limit = request.cache_limit_gb;
  if (cache.empty() && !variant.name.empty()) {
    cache = (base / ".cache").string();
    if (limit < 0) limit = shot.output.cache_limit_gb;  // it is theirs alone, as that of one shot is
  }
  job.arguments = render_arguments(request, job, cache, limit);
  return job;
}

BatchJob unreadable(const std::string& path, const std::string& problem) {
  BatchJob job;
  job.shot = path;
  job.name = fs::path(path).stem().string();
  job.arguments = {"render", path};
  job.problem = problem;
  return job;
}

/// Throws input_error if two jobs would write the same files.
void require_own_files(const std::vector<BatchJob>& jobs) {
  std::map<std::string, const BatchJob*> owners;
  for (const BatchJob& job : jobs) {
    if (!job.problem.empty()) continue;
    std::error_code none;
    const std::string place = fs::weakly_canonical(fs::path(job.folder) / job.name, none).string();
    const auto [owner, is_first] = owners.emplace(place, &job);
    if (is_first) continue;
    throw input_error(fmt::format(
        "batch: {} and {} would write the same files, {}.####.png; nothing was run.\n  Accepted: jobs whose "
        "shot.name or output folder differ. Give one of the shots another shot.name or output.directory, "
        "or run them as two batches with --output.",
        owner->second->shot, job.shot, (fs::path(job.folder) / job.name).string()));
  }
}

/// Throws input_error if a swept field of the shot is given once more, in whatever spelling.
void require_swept_once(const std::vector<SweepAxis>& axes, const std::vector<Override>& sets, const Shot& shot) {
  std::map<std::string, std::string> spellings;  // by full path
  for (const SweepAxis& axis : axes) {
    const auto [other, is_first] = spellings.emplace(full_path({axis.path, "", "--sweep"}, shot), axis.path);
    if (!is_first)
      throw input_error(fmt::format(
          "--sweep: {} and {} are one field of {}.\n  Accepted: each field once. Put all its values into one "
          "--sweep.",
          other->second, axis.path, shot.path));
  }
  for (const Override& set : sets)
    if (const auto swept = spellings.find(full_path(set, shot)); swept != spellings.end())
      throw input_error(
          fmt::format("--sweep: {} is also given by --set.\n  Accepted: one of the two. Take it out of "
                      "--set, or put its value among those of --sweep.",
                      swept->second));
}

/// Throws input_error for fields that an option decides for all jobs: the variants would be named apart, and equal.
void require_own_values(const std::vector<SweepAxis>& axes, const BatchRequest& request, const Shot& shot) {
  const auto refuse = [&](const std::string& path, const std::string& why, const std::string& next) {
    for (const SweepAxis& axis : axes)
      if (full_path({axis.path, "", "--sweep"}, shot) == path)
        throw input_error(fmt::format("--sweep: {} is decided by {}.\n  {}", path, why, next));
  };
  refuse("solver.threads", "the batch, which gives each job its share of the processors",
         "Accepted: other fields. Use --threads and --jobs.");
  if (!request.output.empty())
    refuse("output.directory", "--output", "Accepted: one of the two. Take one of them out.");
  if (!request.cache.empty() || request.cache_limit_gb >= 0)
    refuse("output.cache_limit", request.cache.empty() ? "--cache-limit" : "--cache",
           "Accepted: one of the two. Take one of them out.");
}

}  // namespace

std::string BatchJob::label() const {
  return variant.empty() ? name : name + " " + variant;
}

std::string BatchJob::command_line() const {
  return "softreel " + shell_command(arguments);
}

std::string BatchJob::report_path() const {
  return (fs::path(folder) / (name + ".report.json")).string();
}

std::vector<BatchJob> make_jobs(const BatchRequest& request) {
  std::vector<SweepAxis> axes;
  for (const std::string& text : request.sweeps) axes.push_back(parse_sweep(text));
  std::vector<Override> overrides;
  for (const std::string& text : request.sets) overrides.push_back(parse_override(text));
  const std::vector<Variant> variants = expand_sweeps(axes, kMostJobs / std::max<std::size_t>(1, request.shots.size()));
  std::vector<BatchJob> jobs;
  for (const std::string& path : request.shots) {
    std::string problem;
    // The first variant tells whether the file can be read; what is wrong with its own values read_variant says.
    std::vector<Override> first = overrides;
    if (!variants.empty()) first.insert(first.end(), variants.front().values.begin(), variants.front().values.end());
    std::optional<Shot> shot;
    try {
      shot = read_shot(path, first, problem);
    } catch (const Error&) {
      if (axes.empty()) throw;
      for (const Variant& variant : variants) read_variant(path, overrides, variant);
      throw;
    }
    if (!shot) {
      jobs.push_back(unreadable(path, problem));
      continue;
    }
    require_own_values(axes, request, *shot);
    require_swept_once(axes, overrides, *shot);
    for (const Variant& variant : variants)
      jobs.push_back(make_job(request, path, axes.empty() ? *shot : read_variant(path, overrides, variant), variant));
  }
  require_own_files(jobs);
  return jobs;
}

}  // namespace softreel
