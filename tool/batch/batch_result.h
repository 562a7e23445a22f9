/// What became of the jobs of a batch.
#pragma once

#include <string>
#include <vector>

#include "tool/batch/batch_job.h"
#include "tool/report/energy_history.h"

namespace softreel {

/// What a job would do, found without doing it.
struct JobPlan {
  bool known = false;     ///< false: finding it failed
  bool complete = false;  ///< all is there
  int first_frame = 0, last_frame = 0;
  double tets = 0;
  int simulate_missing = 0, simulate_of = 0;             ///< body frames
  int trace_missing = 0, trace_there = 0, trace_of = 0;  ///< pictures
  double bytes = 0, seconds = 0;                         ///< expected, within a factor of two
};

enum class JobState {
  Waiting,
  Done,
  UpToDate,  ///< all was there already: nothing was run
  Failed,
  Interrupted,  ///< it ran when the user stopped the batch
  NotStarted    ///< the user, or --fail-fast, stopped the batch before
};

const char* word_of(JobState state);

struct StageSeconds {
  std::string stage;
  double seconds = 0;
};

/// What the report of a run says, as far as batches show it.
struct RunFacts {
  std::vector<StageSeconds> stages;  ///< with their sub-stages summed up
  std::vector<BodyEnergies> energies;
  std::vector<std::string> made, skipped;
  int traced = 0, simulated = 0;  ///< by the run itself
};

struct JobResult {
  JobState state = JobState::Waiting;
  JobPlan plan;
  int status = 0;  ///< exit status
  int signal = 0;  ///< that ended it; 0: none
  int attempts = 0, threads = 0;
  bool alone = false;  ///< it is expected to need more memory than there is for all
  double seconds = 0, cpu_seconds = 0, peak_bytes = 0;
  std::string message;  ///< why it failed
  std::vector<std::string> warnings;
  RunFacts facts;
};

struct BatchResult {
  std::vector<BatchJob> jobs;
  std::vector<JobResult> results;  ///< as jobs
  int jobs_at_one_time = 1, threads = 1;
  double bytes = 0;  ///< that all running jobs together might be expected to need
  double seconds = 0;
  bool interrupted = false;
  std::string command;  ///< line of the batch

  int count(JobState state) const;
};

/// Reads JSON of a plan, or of a run's report. What is not there stays as it is; throws nothing.
JobPlan plan_from_json(const std::string& text);
RunFacts facts_from_json(const std::string& text);

/// The whole of a batch, for programs.
std::string to_json(const BatchResult& batch);

}  // namespace softreel
