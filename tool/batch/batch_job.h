/// The jobs of a batch: one for each shot, or for each shot and variant of a sweep.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// What the command line asks for.
struct BatchRequest {
  std::vector<std::string> shots;   ///< paths
  std::vector<std::string> sets;    ///< "path=value", of every job
  std::vector<std::string> sweeps;  ///< "path=value,value,...": every combination is a job
  std::string frames, output, cache;
  double cache_limit_gb = -1;  ///< below 0: the shots'
};

struct BatchJob {
  std::string shot;                    ///< path as given
  std::string name;                    ///< of the shot, which its files start with
  std::string variant;                 ///< folder's name; empty where nothing is swept
  std::vector<std::string> swept;      ///< "path=value" of the variant
  std::vector<std::string> sets;       ///< "path=value", those of the variant last
  std::string folder;                  ///< of the output
  std::vector<std::string> arguments;  ///< of softreel that render it: "render", SHOT, ...
  std::string problem;                 ///< why the shot cannot be read; empty: it can

  /// "NAME" or "NAME VARIANT"
  std::string label() const;
  /// The command line for a shell.
  std::string command_line() const;
  /// FOLDER/NAME.report.json
  std::string report_path() const;
};

/// Makes the jobs, in the order of the shots, and of the variants within each. A variant has a folder of its own in
/// the shot's output folder, and all variants there share a cache. A shot that cannot be read becomes one job with a
/// problem. Throws input_error, before anything is run: for fields and values that a shot does not take, and for two
/// jobs that would write the same files.
std::vector<BatchJob> make_jobs(const BatchRequest& request);

}  // namespace softreel
